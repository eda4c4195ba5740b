// Errors a user can cause, with the place and the range that would have been right.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

namespace touchstone::scene {

/// One fault of an input: its place, what is wrong, what was expected.
struct Fault {
  std::string file;  ///< path, "--set" for an override, or empty when the fault has no file
  int line = 0;      ///< 1-based; 0 when unknown
  int column = 0;    ///< 1-based; 0 when unknown
  std::string message;

  /// "file:line:column: message" on one line, control characters visible; without what is unknown, cut if very long.
  [[nodiscard]] std::string text() const;
};

/// Bad input. Carries every fault found; what() lists one per line, the first faults_shown_max and how many more.
class InputError : public std::runtime_error {
 public:
  explicit InputError(std::vector<Fault> faults);
  /// One fault without a place in a file.
  explicit InputError(const std::string& message);
  [[nodiscard]] const std::vector<Fault>& faults() const noexcept { return faults_; }

 private:
  std::vector<Fault> faults_;
};

}  // namespace touchstone::scene
