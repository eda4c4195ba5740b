// `touchstone verify`: the reference against closed forms and published benchmarks.
#pragma once

#include "fast/command/command.h"
#include "reference/verification/problem.h"
#include "scene/output/results.h"

#include <filesystem>
#include <string>
#include <vector>

namespace touchstone::compare {

struct VerifyOptions {
  std::vector<std::string> names;  ///< of problems; empty: all
  bool quick = false;
  bool list = false;
  bool quiet = false;
  std::filesystem::path out = "out/verify";
};

/// What became of one problem.
struct ProblemRecord {
  std::string name, title, source;
  verification::Findings findings;
  std::string failure;  ///< why it has no answer; empty when it has
  scene::StageTime time;

  [[nodiscard]] bool passes() const;
};

/// Runs some problems. One that does not converge is recorded as failed; the others still run.
/// @throws scene::InputError for a name that is none of `all`, before any work
[[nodiscard]] std::vector<ProblemRecord> run_problems(const std::vector<verification::Problem>& all,
                                                      const VerifyOptions& options);

/// The table: problem, target, value, error, limit, uncertainty of the mesh, observed order, pass or MISS.
[[nodiscard]] std::string verify_text(const std::vector<ProblemRecord>& records);

/// Per problem `verify.<name>.checks|missed|largest_error_over_limit`, per check its target, value, error, limit.
[[nodiscard]] scene::Figures verify_figures(const std::vector<ProblemRecord>& records);

/// The same as a page.
[[nodiscard]] std::string verify_html(const std::vector<ProblemRecord>& records, const scene::Manifest& manifest);

/// @returns exit code: answer_is_no when a problem misses
int verify(const VerifyOptions& options, const std::string& command,
           const std::vector<verification::Problem>& all = verification::problems());

void add_verify_verb(fast::Command& program, VerifyOptions& options);

}  // namespace touchstone::compare
