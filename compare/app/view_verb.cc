#include "compare/app/view_verb.h"

#include "compare/report/result_folder.h"
#include "compare/view/view.h"
#include "compare/view/virtual_display.h"
#include "fast/command/command_line.h"
#include "scene/base/error.h"
#include "scene/base/nearest_name.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <iostream>
#include <optional>

namespace touchstone::compare {
namespace {

/// Presses a key until the view shows what was asked for.
template <class Says>
void press_until(ResultView& view, const std::string& key, const std::string& wanted, const char* option, Says says) {
  if (wanted.empty()) return;
  const std::string first = says();
  std::vector<std::string> known{first};
  while (says() != wanted) {
    view.press(key);
    if (says() == first) {
      throw scene::InputError(fmt::format("{} {}: this result has {}{}", option, wanted, fmt::join(known, ", "),
                                          scene::did_you_mean(wanted, known)));
    }
    known.push_back(says());
  }
}

}  // namespace

int view_result(const ViewOptions& options) {
  if (!options.screenshot.empty() && !ResultView::can_write(options.screenshot)) {
    throw scene::InputError("--screenshot " + options.screenshot.string() +
                            ": unknown extension; expected .png, .jpg or .jpeg");
  }
  const ResultFolder result = read_result_folder(options.folder);
  std::optional<VirtualDisplay> display;
  if (!has_display()) {
    std::cerr << "no display here (DISPLAY names none)"
              << (options.screenshot.empty() ? "; --screenshot FILE.png writes the picture without one\n"
                                             : ", so no window: writing the picture only\n");
    if (options.screenshot.empty()) return fast::bad_input;
    display.emplace();
  }
  ResultView view(result);
  if (options.instant > 0) {
    const int count = static_cast<int>(view.instant_count());
    if (options.instant > count) {
      throw scene::InputError(fmt::format("--instant {}: expected 1 to {}", options.instant, count));
    }
    view.show_instant(options.instant - 1);
  }
  press_until(view, "b", options.side, "--side", [&] { return view.side(); });
  press_until(view, "c", options.colour, "--colour", [&] { return view.colour(); });
  if (options.screenshot.empty()) {
    view.run();
  } else {
    view.write_picture(options.screenshot);
    std::cout << "Picture: " << options.screenshot.string() << '\n';
  }
  return fast::done;
}

fast::Command add_view_verb(fast::Command& program, ViewOptions& options) {
  fast::Command verb = program.add("view", "show a result in a window: body, tool, force curve, one instant at a time");
  verb.option("DIR", options.folder, "result folder of fast, reference or compare").required();
  verb.option("--screenshot", options.screenshot, "write this PNG or JPEG file, by its extension, and open no window");
  verb.option("--instant", options.instant, "show this instant, from 1 (default: the deepest)").positive();
  verb.option("--side", options.side, "reference or fast model");
  verb.option("--colour", options.colour, "displacement, error or uncertainty");
  verb.action([&options] { return view_result(options); });
  verb.footer("Keys:\n" + ResultView::keys_text() + "\n\nExample:\n  " + program.program_name() +
              " view out/ball-on-cube-press-compare --colour error --screenshot error.png");
  return verb;
}

}  // namespace touchstone::compare
