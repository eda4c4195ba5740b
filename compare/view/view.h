// The window on a result: the deformed body in space with the tool, the force curve beside it, the instant by a slider.
#pragma once

#include "compare/report/result_folder.h"

#include <filesystem>
#include <memory>
#include <string>

namespace touchstone::compare {

/// Needs a display, of screen or Xvfb, from make_window() on.
class ResultView {
 public:
  /// Reads the surfaces of every instant.
  /// @throws scene::InputError when a surface is missing, damaged, or not of the size of the others
  explicit ResultView(const ResultFolder& result);
  ~ResultView();

  [[nodiscard]] std::size_t instant_count() const;
  [[nodiscard]] std::size_t instant() const;
  [[nodiscard]] std::string side() const;    ///< shown: "reference", "fast model", or "body" where there is one only
  [[nodiscard]] std::string colour() const;  ///< what colours the body, such as "error"
  [[nodiscard]] std::string words() const;   ///< over the picture: instant, depth, forces

  /// Clamped to the instants there are.
  void show_instant(long instant);
  /// As the keyboard does; the names are X's, such as "Right" and "c". @returns false for a key without a meaning
  bool press(const std::string& key);
  /// Lines of "key  meaning".
  [[nodiscard]] static std::string keys_text();

  /// Can write_picture() write a file of this ending?
  [[nodiscard]] static bool can_write(const std::filesystem::path& file);
  /// The window off the screen, as a PNG or JPEG by the file's ending: .png, .jpg or .jpeg, in any case of letters.
  /// @throws scene::InputError for another ending, std::filesystem::filesystem_error
  void write_picture(const std::filesystem::path& file);
  /// Opens the window and returns when it is closed.
  void run();

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace touchstone::compare
