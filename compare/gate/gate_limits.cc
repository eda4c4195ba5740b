#include "compare/gate/gate_limits.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <sstream>

namespace touchstone::compare {
namespace {

/// Output of git in a folder, or nothing if git fails.
std::optional<std::string> git(const std::filesystem::path& folder, std::vector<std::string> arguments) {
  std::vector<std::string> words{"git", "-C", folder.string()};
  for (std::string& argument : arguments) words.push_back(std::move(argument));
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) return std::nullopt;
  const pid_t child = fork();
  if (child == 0) {
    const int nowhere = open("/dev/null", O_WRONLY);
    if (dup2(ends[1], STDOUT_FILENO) >= 0 && dup2(nowhere, STDERR_FILENO) >= 0) execvp("git", pointers.data());
    _exit(127);
  }
  close(ends[1]);
  std::string text;
  std::array<char, 4096> some{};
  for (ssize_t got = 0; child > 0; text.append(some.data(), static_cast<std::size_t>(got))) {
    while ((got = read(ends[0], some.data(), some.size())) < 0 && errno == EINTR) continue;
    if (got <= 0) break;
  }
  close(ends[0]);
  int status = -1;
  while (child > 0 && waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  return child > 0 && WIFEXITED(status) && WEXITSTATUS(status) == 0 ? std::optional(text) : std::nullopt;
}

const Gate* find_gate(const std::vector<GateFile>& files, const std::string& name) {
  for (const GateFile& file : files) {
    for (const Gate& gate : file.gates) {
      if (file.name + "." + gate.name == name) return &gate;
    }
  }
  return nullptr;
}

std::string date_text(std::chrono::year_month_day day) {
  return fmt::format("{:04}-{:02}-{:02}", static_cast<int>(day.year()), static_cast<unsigned>(day.month()),
                     static_cast<unsigned>(day.day()));
}

/// In which respect a gate became weaker; empty if it did not.
std::string loosened(const GateFile& base_file, const Gate& base, const GateFile& file, const Gate& gate) {
  const auto changed = [](const char* what, const std::string& before, const std::string& now) {
    return fmt::format("{} \"{}\" instead of \"{}\"", what, now, before);
  };
  if (base.quantity != gate.quantity) return changed("quantity", base.quantity, gate.quantity);
  if (base.kind != gate.kind) return changed("kind", name_of(base.kind), name_of(gate.kind));
  if (base.unit != gate.unit) return changed("unit", base.unit, gate.unit);
  if (base_file.run != file.run) return changed("run", name_of(base_file.run), name_of(file.run));
  if (base_file.model != file.model) return changed("model", base_file.model, file.model);
  if (gate.limit > base.limit) return fmt::format("limit {} wider than {}", gate.limit, base.limit);
  return "";
}

}  // namespace

std::chrono::year_month_day today() { return std::chrono::floor<std::chrono::days>(std::chrono::system_clock::now()); }

BaseGates base_gates(const std::filesystem::path& folder, const std::string& commit) {
  BaseGates base{commit, {}};
  if (commit.starts_with("-") || !git(folder, {"rev-parse", "--verify", "--quiet", commit + "^{commit}"})) {
    throw scene::InputError("--base " + commit + ": git knows no such commit for " + folder.string() +
                            "; expected a branch or commit, such as origin/main");
  }
  std::istringstream names(git(folder, {"ls-tree", "--name-only", commit, "./"}).value_or(""));
  for (std::string name; std::getline(names, name);) {
    if (!name.ends_with(".toml") || name == "waivers.toml") continue;
    const std::optional<std::string> text = git(folder, {"show", commit + ":./" + name});
    if (!text) throw scene::InputError("--base " + commit + ": git cannot show " + name);
    base.files.push_back(parse_gate_file(*text, commit + ":" + (folder / name).string()));
  }
  return base;
}

std::vector<std::string> hold_limits(const GateFolder& folder, const BaseGates* base, std::chrono::year_month_day today,
                                     std::vector<GateRecord>& records) {
  std::vector<std::string> faults;
  const auto waived = [&](const std::string& gate, bool removed) {
    return std::ranges::any_of(folder.waivers, [&](const GateWaiver& waiver) {
      return waiver.gate == gate && waiver.removed == removed && today <= waiver.until;
    });
  };
  for (const GateWaiver& waiver : folder.waivers) {
    scene::Fault fault = waiver.place;
    const bool there = find_gate(folder.files, waiver.gate) != nullptr;
    if (today > waiver.until) {
      fault.message =
          fmt::format("the waiver of {} by {} held until {}", waiver.gate, waiver.name, date_text(waiver.until));
    } else if (there == waiver.removed) {
      fault.message = fmt::format("the waiver of {} is for no gate: there is {}", waiver.gate,
                                  there ? "one, and removed = true" : "none, and removed = false");
    } else {
      continue;
    }
    faults.push_back(fault.text());
  }
  if (base == nullptr) return faults;
  for (const GateFile& base_file : base->files) {
    for (const Gate& before : base_file.gates) {
      const std::string name = base_file.name + "." + before.name;
      const Gate* gate = find_gate(folder.files, name);
      if (gate == nullptr) {
        if (!waived(name, true)) {
          faults.push_back(fmt::format("{} of {} is gone; expected it, or a waiver with removed = true in {}", name,
                                       base->commit, (folder.folder / "waivers.toml").string()));
        }
        continue;
      }
      const GateFile& file = *std::ranges::find(folder.files, base_file.name, &GateFile::name);
      const std::string why = loosened(base_file, before, file, *gate);
      if (why.empty() || waived(name, false)) continue;
      for (GateRecord& record : records) {
        if (record.name() != name || !record.failure.empty()) continue;
        record.failure = fmt::format("{} at {}; expected a waiver for that", why, base->commit);
      }
    }
  }
  return faults;
}

}  // namespace touchstone::compare
