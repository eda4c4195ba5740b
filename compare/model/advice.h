// What may be said after a comparison: reasons, and steps to take next.
#pragma once

#include "compare/errors/errors.h"
#include "scene/model/scene.h"

#include <cstdint>
#include <string>

namespace touchstone::compare {

/// One paragraph of an explanation.
struct Reason {
  std::string about;        ///< what it is about, "Force"
  std::string brief = {};   ///< for terminal and page; may be empty
  std::string detail = {};  ///< for the page alone; may be empty

  [[nodiscard]] std::string text() const { return brief + (brief.empty() || detail.empty() ? "" : " ") + detail; }
};

/// The two errors by which a trial is judged, as in Errors.
struct Trial {
  double force_nrmse = 0.0, shape_rel_l2 = 0.0;
  std::uint32_t status = 0;  ///< of the steps
};

/// A comparison, as the model that it is about sees it when it suggests steps.
class Advice {
 public:
  /// A trial is suggested if the remaining error is at most this fraction of the present one.
  static constexpr double worth_it = 0.8;
  /// Smaller errors need no better constants.
  static constexpr double small_error = 0.05;

  virtual ~Advice() = default;
  [[nodiscard]] virtual const scene::Scene& scene() const = 0;
  [[nodiscard]] virtual const Errors& errors() const = 0;
  [[nodiscard]] virtual std::uint32_t status() const = 0;  ///< of the steps
  /// The changed scene's errors against the same answer of the reference.
  [[nodiscard]] virtual Trial tried(const scene::Scene& changed) const = 0;
  [[nodiscard]] virtual bool time_left() const = 0;  ///< for further trials
  /// Suggests the command again, with more options.
  virtual void again(const std::string& why, const std::string& options) = 0;
  /// Suggests the command again, with a file of parameters NAME.toml of this text.
  virtual void with_parameters(const std::string& why, const std::string& name, const std::string& text) = 0;
  /// Suggests to tune the scene's constants where an error is large.
  /// @param example  of a study, where the scene has none; @param tried  a sentence with a space before, or empty
  virtual void tune(const std::string& example, const std::string& tried) = 0;
};

}  // namespace touchstone::compare
