#include "reference/response/prepare.h"

#include "scene/base/error.h"
#include "scene/base/files.h"
#include "scene/base/stopwatch.h"
#include "scene/response/response_file.h"

#include <fmt/format.h>

#include <charconv>
#include <optional>
#include <utility>

namespace touchstone::reference {
namespace {

constexpr double keep_every_s = 5.0;

/// The file of finished columns: their number, a line feed, and a response file of an identity with that number.
std::string unfinished_identity(const std::string& identity, Eigen::Index done) {
  return identity + fmt::format("the first {} columns\n", done);
}

void keep(const std::filesystem::path& file, const std::string& identity, const FirstColumns& first) {
  scene::write_file(file, fmt::format("{}\n", first.done) +
                              scene::response_bytes(first.response, unfinished_identity(identity, first.done)));
}

/// None where the file is not there, damaged or of another body.
FirstColumns kept(const std::filesystem::path& file, const std::string& identity) {
  const std::string bytes = scene::read_file(file).value_or("");
  FirstColumns out;
  const auto [end, fault] = std::from_chars(bytes.data(), bytes.data() + bytes.size(), out.done);
  const auto content = static_cast<std::size_t>(end - bytes.data()) + 1;
  if (fault != std::errc() || content > bytes.size()) return {};
  try {
    out.response = scene::response_from(bytes.substr(content), unfinished_identity(identity, out.done));
  } catch (const scene::InputError&) {
    return {};
  }
  return out;
}

}  // namespace

Prepared prepare_response(const scene::Scene& scene, const scene::Surface& surface, const std::filesystem::path& store,
                          const std::function<void(const SmoothProgress&)>& progress) {
  const scene::FoundGrid found = scene::load_grid(scene);
  if (!found.grid) throw scene::InputError("the response model needs that " + found.why);
  const scene::LoadKinds loads = scene::load_kinds(scene);
  const std::string identity = scene::response_identity(scene.body, *found.grid, surface, loads);
  Prepared out;
  out.file = scene::response_path(store, identity);
  if (std::filesystem::exists(out.file)) {
    try {
      out.response = scene::read_response(out.file, identity);
      return out;
    } catch (const scene::InputError&) {
      // A damaged file is computed anew.
    }
  }
  scene::require_writable(out.file.parent_path(), "--store");
  const std::filesystem::path unfinished = std::filesystem::path(out.file).replace_extension("unfinished");
  const scene::Stopwatch watch;
  double kept_s = 0.0;
  const auto keep_and_say = [&](const SmoothProgress& now) {
    const bool wanted = now.next == SmoothProgress::Next::column;
    if (wanted && watch.wall_s() - kept_s > keep_every_s) {
      keep(unfinished, identity, now.first);
      kept_s = watch.wall_s();
    }
    if (!progress) return;
    try {
      progress(now);
    } catch (...) {
      if (wanted) keep(unfinished, identity, now.first);
      throw;
    }
  };
  const SmoothResponseOptions options{.loads = loads};
  out.response =
      smooth_response(scene.body, *found.grid, surface.points_m, options, keep_and_say, kept(unfinished, identity));
  out.computed = true;
  out.seconds = watch.wall_s();
  scene::write_file(out.file, scene::response_bytes(out.response, identity));
  std::filesystem::remove(unfinished);
  return out;
}

}  // namespace touchstone::reference
