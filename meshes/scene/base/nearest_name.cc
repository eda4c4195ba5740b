#include "scene/base/nearest_name.h"

#include "scene/base/text.h"

#include <algorithm>

namespace touchstone::scene {
namespace {

/// Longer than any key; the cost grows with the length.
constexpr std::size_t name_size_max = 100;

/// Edit distance with transpositions, to suggest a similar key.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = i;
  for (std::size_t j = 0; j <= b.size(); ++j) d[0][j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    for (std::size_t j = 1; j <= b.size(); ++j) {
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  }
  return d[a.size()][b.size()];
}

/// Number of characters without the leading dashes of an option.
std::size_t letters(std::string_view name) { return name.size() - std::min(name.find_first_not_of('-'), name.size()); }

}  // namespace

std::string unknown_key(const std::string& shown, std::string_view name, const std::vector<std::string>& known,
                        std::size_t told) {
  std::string message = "unknown key \"" + shortened(shown) + "\"";
  if (name.size() > name_size_max) return message + "; no key is that long";
  if (told >= faults_shown_max) return message;
  return message + "; did you mean \"" + nearest_name(name, known) + "\"?";
}

std::string nearest_name(std::string_view name, const std::vector<std::string>& known) {
  const auto best = std::min_element(known.begin(), known.end(), [&](const std::string& a, const std::string& b) {
    return edit_distance(name, a) < edit_distance(name, b);
  });
  return *best;
}

std::string did_you_mean(std::string_view name, const std::vector<std::string>& known) {
  if (known.empty() || name.size() > name_size_max) return "";
  const std::string nearest = nearest_name(name, known);
  if (2 * edit_distance(name, nearest) > std::max(letters(name), letters(nearest))) return "";
  return "; did you mean \"" + nearest + "\"?";
}

std::string did_you_mean_file(const std::filesystem::path& missing) {
  const std::filesystem::path folder = missing.has_parent_path() ? missing.parent_path() : ".";
  std::error_code error;
  if (!std::filesystem::is_directory(folder, error)) return "; there is no folder " + folder.string();
  std::vector<std::string> names, others;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    if (!entry.is_regular_file(error)) continue;
    (entry.path().extension() == missing.extension() ? names : others).push_back(entry.path().filename().string());
  }
  std::ranges::sort(names);
  std::ranges::sort(others);
  // Without the extension, which all files share.
  std::vector<std::string> stems;
  for (const std::string& name : names) stems.push_back(std::filesystem::path(name).stem().string());
  const std::string stem = missing.stem().string();
  std::string nearest;
  if (!did_you_mean(stem, stems).empty()) {
    nearest = nearest_name(stem, stems) + missing.extension().string();
  } else if (!did_you_mean(missing.filename().string(), others).empty()) {
    nearest = nearest_name(missing.filename().string(), others);
  } else {
    return "";
  }
  return "; did you mean \"" + (missing.parent_path() / nearest).string() + "\"?";
}

}  // namespace touchstone::scene
