// The window under Xvfb: key presses as from a user, and pictures without any display.
#include "compare/view/view.h"

#include "compare/comparison/compare.h"
#include "compare/view/virtual_display.h"
#include "scene/base/error.h"
#include "scene/input/scene_io.h"
#include "support/source_folder.h"
#include "support/synthetic.h"
#include "support/temporary_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>
#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkJPEGReader.h>
#include <vtkNew.h>
#include <vtkPNGReader.h>
#include <vtkPointData.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <set>

// Included last: its macros use common words.
#include <X11/Xlib.h>
#include <X11/Xutil.h>
#include <X11/keysym.h>

namespace touchstone::compare {
namespace {

using ::testing::HasSubstr;
using Rgb = std::array<int, 3>;

class ViewTest : public ::testing::Test {
 protected:
  ViewTest() {
    testing::Sides sides = testing::pressed(4, 600);
    sides.manifest.command = "touchstone compare";
    sides.manifest.resolved_scene =
        scene::resolved_toml(scene::load_scene(source_folder() + "/meshes/scenes/ball-on-cube-press.toml"));
    (void)write_comparison(folder_.path(), sides.scene, sides.run, sides.result, sides.manifest, {});
  }

  [[nodiscard]] std::vector<Rgb> pixels_of(const std::filesystem::path& file) const {
    vtkNew<vtkPNGReader> reader;
    reader->SetFileName(file.c_str());
    reader->Update();
    vtkDataArray* colours = reader->GetOutput()->GetPointData()->GetScalars();
    std::vector<Rgb> out;
    for (vtkIdType i = 0; colours != nullptr && i < colours->GetNumberOfTuples(); ++i) {
      Rgb pixel;
      for (int k = 0; k < 3; ++k) pixel[static_cast<std::size_t>(k)] = static_cast<int>(colours->GetComponent(i, k));
      out.push_back(pixel);
    }
    return out;
  }
  std::vector<Rgb> picture(ResultView& view) {
    const std::filesystem::path file = folder_.path() / "picture.png";
    view.write_picture(file);
    return pixels_of(file);
  }

  testing::TemporaryFolder folder_;
};

/// Fraction of the pixels that differ.
double difference(const std::vector<Rgb>& a, const std::vector<Rgb>& b) {
  if (a.size() != b.size()) return 1.0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) count += a[i] != b[i] ? 1 : 0;
  return static_cast<double>(count) / static_cast<double>(a.size());
}

/// What a program printed on both streams, and how it ended.
struct Ended {
  int code = -1;
  std::string text;
};
Ended run(const std::string& command) {
  Ended out;
  FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  char buffer[4096];
  for (std::size_t n = 0; (n = fread(buffer, 1, sizeof buffer, pipe)) > 0;) out.text.append(buffer, n);
  out.code = WEXITSTATUS(pclose(pipe));
  return out;
}

TEST_F(ViewTest, EveryKeyChangesThePictureAndBackAgain) {
  const VirtualDisplay display;
  ResultView view(read_result_folder(folder_.path()));
  EXPECT_EQ(view.instant(), 3u) << "begins at the deepest";
  const std::vector<Rgb> first = picture(view);
  EXPECT_GT(std::set<Rgb>(first.begin(), first.end()).size(), 200u) << "nearly blank";
  EXPECT_EQ(difference(first, picture(view)), 0.0);
  const std::pair<std::vector<std::string>, std::vector<std::string>> there_and_back[] = {
      {{"Left"}, {"Right"}}, {{"Home"}, {"End"}}, {{"b"}, {"b"}}, {{"c"}, {"c", "c"}}, {{"t"}, {"t"}}, {{"h"}, {"h"}}};
  for (const auto& [there, back] : there_and_back) {
    for (const std::string& key : there) EXPECT_TRUE(view.press(key));
    EXPECT_GT(difference(first, picture(view)), 0.001) << there.front();
    for (const std::string& key : back) EXPECT_TRUE(view.press(key));
    EXPECT_EQ(difference(first, picture(view)), 0.0) << there.front();
  }
  EXPECT_FALSE(view.press("F7"));
}

TEST_F(ViewTest, InstantsEndWhereTheTrackDoes) {
  const VirtualDisplay display;
  ResultView view(read_result_folder(folder_.path()));
  view.press("Right");
  EXPECT_EQ(view.instant(), 3u);
  view.press("Home");
  view.press("Left");
  EXPECT_EQ(view.instant(), 0u);
  view.press("Right");
  EXPECT_EQ(view.instant(), 1u);
  EXPECT_EQ(view.side(), "reference");
  view.press("b");
  EXPECT_EQ(view.side(), "fast model");
  EXPECT_EQ(view.colour(), "displacement");
  view.press("c");
  EXPECT_EQ(view.colour(), "error");
}

TEST_F(ViewTest, NamesASurfaceThatIsMissingOrDamaged) {
  const std::filesystem::path file = folder_.path() / "surface_0002.vtp";
  const auto fault = [&] {
    try {
      ResultView view(read_result_folder(folder_.path()));
    } catch (const scene::InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  std::filesystem::resize_file(file, 300);
  EXPECT_THAT(fault(), HasSubstr(file.string() + ": is no VTK surface"));
  std::filesystem::remove(file);
  EXPECT_THAT(fault(), HasSubstr(file.string() + ": is missing"));
}

TEST_F(ViewTest, ShowsAMeshToolFromAFolderThatWasMoved) {
  const testing::TemporaryFolder elsewhere;
  const testing::Sides sides = testing::pressed_by_mallet(elsewhere.path() / "inputs");
  const std::filesystem::path made = elsewhere.path() / "made", moved = folder_.path() / "moved";
  std::filesystem::create_directories(made);
  (void)write_comparison(made, sides.scene, sides.run, sides.result, sides.manifest, {});
  std::filesystem::remove_all(elsewhere.path() / "inputs");
  std::filesystem::rename(made, moved);
  const VirtualDisplay display;
  ResultView view(read_result_folder(moved));
  const std::vector<Rgb> with_tool = picture(view);
  view.press("t");
  EXPECT_GT(difference(with_tool, picture(view)), 0.01) << "the tool is not in the picture";
}

TEST_F(ViewTest, SaysThatAnUncertaintyIsUnknownAndLeavesTheBodyGrey) {
  testing::Sides sides = testing::pressed(4, 600);
  for (scene::ReferenceInstant& instant : sides.result.instants) {
    Eigen::VectorXd& u_m = instant.displacement_uncertainty_m;
    u_m.setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  sides.manifest.resolved_scene = read_result_folder(folder_.path()).resolved_scene;
  (void)write_comparison(folder_.path(), sides.scene, sides.run, sides.result, sides.manifest, {});
  const VirtualDisplay display;
  ResultView view(read_result_folder(folder_.path()));
  view.press("c");
  view.press("t");  // the tool is grey, too
  const auto coloured = [](const std::vector<Rgb>& pixels) {
    // Left of the curve; a coloured pixel's channels differ, as no grey one's do.
    return std::count_if(pixels.begin(), pixels.end(), [](const Rgb& p) {
      return *std::max_element(p.begin(), p.end()) - *std::min_element(p.begin(), p.end()) > 60;
    });
  };
  ASSERT_EQ(view.colour(), "error");
  EXPECT_EQ(view.words().find("unknown"), std::string::npos);
  const auto with_error = coloured(picture(view));
  view.press("c");
  ASSERT_EQ(view.colour(), "uncertainty");
  EXPECT_NE(view.words().find("The uncertainty is unknown"), std::string::npos);
  EXPECT_LT(coloured(picture(view)), with_error / 2);
}

TEST_F(ViewTest, WritesTheFormatThatTheEndingNames) {
  const VirtualDisplay display;
  ResultView view(read_result_folder(folder_.path()));
  const auto first_bytes = [&](const char* name) {
    view.write_picture(folder_.path() / name);
    return scene::read_file(folder_.path() / name).value().substr(0, 4);
  };
  EXPECT_EQ(first_bytes("a.png"), "\x89PNG");
  EXPECT_EQ(first_bytes("a.PNG"), "\x89PNG");
  EXPECT_EQ(first_bytes("a.jpg").substr(0, 3), "\xFF\xD8\xFF");
  EXPECT_EQ(first_bytes("a.JPEG").substr(0, 3), "\xFF\xD8\xFF");
  vtkNew<vtkJPEGReader> reader;
  reader->SetFileName((folder_.path() / "a.jpg").c_str());
  reader->Update();
  vtkDataArray* colours = reader->GetOutput()->GetPointData()->GetScalars();
  ASSERT_NE(colours, nullptr);
  const std::vector<Rgb> exact = pixels_of(folder_.path() / "a.png");
  ASSERT_EQ(colours->GetNumberOfTuples(), static_cast<vtkIdType>(exact.size()));
  double apart = 0.0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      apart += std::abs(colours->GetComponent(static_cast<vtkIdType>(i), k) - exact[i][static_cast<std::size_t>(k)]);
    }
  }
  EXPECT_LT(apart / (3.0 * static_cast<double>(exact.size())), 2.0) << "mean difference of a colour, of 255";
  EXPECT_THROW(view.write_picture(folder_.path() / "a.gif"), scene::InputError);
}

TEST_F(ViewTest, RefusesAPictureOfAnotherEndingBeforeAnyWork) {
  for (const char* name : {"a.bmp", "a", "jpg"}) {
    const Ended refused =
        run(std::string(TOUCHSTONE_BINARY) + " view /no/such/result --screenshot " + (folder_.path() / name).string());
    EXPECT_EQ(refused.code, 2);
    EXPECT_THAT(refused.text, HasSubstr(std::string(name) + ": unknown extension; expected .png, .jpg or .jpeg"));
  }
}

TEST_F(ViewTest, WithoutADisplaySaysSoInOneLineAndWritesThePictureIfAsked) {
  const std::string program = std::string("env -u DISPLAY ") + TOUCHSTONE_BINARY + " view " + folder_.path().string();
  const Ended refused = run(program);
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.text, HasSubstr("no display"));
  EXPECT_EQ(std::count(refused.text.begin(), refused.text.end(), '\n'), 1) << refused.text;
  const std::filesystem::path file = folder_.path() / "asked.png";
  const Ended written = run(program + " --instant 2 --colour error --screenshot " + file.string());
  EXPECT_EQ(written.code, 0) << written.text;
  const std::vector<Rgb> pixels = pixels_of(file);
  EXPECT_GT(std::set<Rgb>(pixels.begin(), pixels.end()).size(), 200u);
  const Ended none = run(program + " --colour eror --screenshot " + file.string());
  EXPECT_EQ(none.code, 2);
  EXPECT_THAT(none.text, HasSubstr("this result has displacement, error, uncertainty; did you mean \"error\"?"));
  EXPECT_EQ(run(program + " --instant 5 --screenshot " + file.string()).code, 2);
}

/// The window of this name below another, or 0.
Window find_window(Display* display, Window below, const std::string& name) {
  char* title = nullptr;
  if (XFetchName(display, below, &title) != 0 && title != nullptr) {
    const bool found = name == title;
    XFree(title);
    if (found) return below;
  }
  Window root = 0, parent = 0, *children = nullptr;
  unsigned int count = 0;
  if (XQueryTree(display, below, &root, &parent, &children, &count) == 0) return 0;
  Window found = 0;
  for (unsigned int i = 0; i < count && found == 0; ++i) found = find_window(display, children[i], name);
  if (children != nullptr) XFree(children);
  return found;
}

/// Empty for a window that is not shown yet.
std::vector<unsigned long> window_pixels(Display* display, Window window) {
  XWindowAttributes size;
  std::vector<unsigned long> out;
  if (XGetWindowAttributes(display, window, &size) == 0 || size.map_state != IsViewable) return out;
  XImage* image = XGetImage(display, window, 0, 0, static_cast<unsigned>(size.width),
                            static_cast<unsigned>(size.height), AllPlanes, ZPixmap);
  if (image == nullptr) return out;
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) out.push_back(XGetPixel(image, x, y));
  }
  XDestroyImage(image);
  return out;
}

/// Repeats a check until it holds or a minute has passed.
template <class IsSo>
bool comes_true(IsSo is_so) {
  for (int i = 0; i < 600; ++i) {
    if (is_so()) return true;
    usleep(100'000);
  }
  return false;
}

/// A program that is stopped with its test; the test runner would wait for its output.
class Program {
 public:
  explicit Program(const char* const* arguments) {
    started_ =
        posix_spawn(&process_, arguments[0], nullptr, nullptr, const_cast<char* const*>(arguments), environ) == 0;
  }
  ~Program() {
    if (!started_ || ended()) return;
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
  }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;
  [[nodiscard]] bool started() const { return started_; }
  [[nodiscard]] bool ended() { return ended_ || (ended_ = waitpid(process_, &status_, WNOHANG) == process_); }
  /// Once it has ended.
  [[nodiscard]] bool well() const { return WIFEXITED(status_) && WEXITSTATUS(status_) == 0; }

 private:
  pid_t process_ = 0;
  int status_ = -1;
  bool started_ = false, ended_ = false;
};

TEST_F(ViewTest, TheWindowFollowsTheKeyboardOfAnXServer) {
  const VirtualDisplay x_server;
  // A window may change between two requests; Xlib's own handler would end the test there.
  XSetErrorHandler([](Display*, XErrorEvent*) { return 0; });
  Display* display = XOpenDisplay(nullptr);
  ASSERT_NE(display, nullptr);
  const std::string folder = folder_.path().string();
  const char* arguments[] = {TOUCHSTONE_BINARY, "view", folder.c_str(), nullptr};
  Program program(arguments);
  ASSERT_TRUE(program.started());
  Window window = 0;
  const auto drawn = [&] {
    if (window == 0) window = find_window(display, DefaultRootWindow(display), "Touchstone");
    if (window == 0) return false;
    const std::vector<unsigned long> pixels = window_pixels(display, window);
    return std::set<unsigned long>(pixels.begin(), pixels.end()).size() > 200;
  };
  ASSERT_TRUE(comes_true(drawn));
  const auto press = [&](KeySym key) {
    XKeyEvent event{};
    event.type = KeyPress;
    event.display = display;
    event.window = window;
    event.root = DefaultRootWindow(display);
    event.same_screen = True;
    event.keycode = XKeysymToKeycode(display, key);
    XSendEvent(display, window, True, KeyPressMask, reinterpret_cast<XEvent*>(&event));
    XFlush(display);
  };
  for (const KeySym key : {XK_Left, XK_c, XK_b}) {
    const std::vector<unsigned long> before = window_pixels(display, window);
    press(key);
    EXPECT_TRUE(comes_true([&] {
      const std::vector<unsigned long> now = window_pixels(display, window);
      return !now.empty() && now != before;
    })) << XKeysymToString(key);
  }
  press(XK_q);
  EXPECT_TRUE(comes_true([&] { return program.ended(); }));
  EXPECT_TRUE(program.well());
  XCloseDisplay(display);
}

}  // namespace
}  // namespace touchstone::compare
