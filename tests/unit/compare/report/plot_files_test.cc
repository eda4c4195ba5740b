#include "compare/report/plot_files.h"

#include "compare/comparison/compare.h"
#include "compare/errors/compute_errors.h"
#include "compare/report/comparison_drawings.h"
#include "scene/base/files.h"
#include "support/synthetic.h"
#include "support/temporary_folder.h"
#include "support/xml.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace touchstone::compare {
namespace {

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(PlotFiles, EveryPlotOfTheReportIsSavedWhenAsked) {
  const testing::Sides sides = testing::pressed(4, 200);
  const testing::TemporaryFolder folder;
  (void)write_comparison(folder.path(), sides.scene, sides.run, sides.result, sides.manifest, {});
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "plots"));
  (void)write_comparison(folder.path(), sides.scene, sides.run, sides.result, sides.manifest, {},
                         {.compare = {.plots = true}});
  std::set<std::string> svg, pdf;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path() / "plots")) {
    const std::string text = scene::read_file(entry.path()).value();
    if (entry.path().extension() == ".svg") {
      svg.insert(entry.path().stem());
      EXPECT_TRUE(testing::is_well_formed(text)) << entry.path();
      EXPECT_TRUE(has(text, "fill=\"#ffffff\"")) << entry.path();
    } else {
      pdf.insert(entry.path().stem());
      EXPECT_TRUE(text.starts_with("%PDF-")) << entry.path();
    }
  }
  EXPECT_EQ(svg, (std::set<std::string>{"bodies", "contact-size", "force-error", "force-logarithmic",
                                        "force-over-depth", "force-over-time", "section", "section-contact",
                                        "shape-error", "shape-largest-error", "traction"}));
  EXPECT_EQ(pdf, has_pdf() ? svg : std::set<std::string>{});
}

TEST(PlotFiles, OldOnesGoAndOtherFilesStay) {
  const testing::TemporaryFolder folder;
  const std::filesystem::path plots = folder.path() / "plots";
  std::filesystem::create_directories(plots);
  for (const char* name : {"friction.svg", "friction.pdf", "my-own.svg"}) scene::write_file(plots / name, "old");
  const testing::Sides sides = testing::pressed(4, 200);
  (void)write_comparison(folder.path(), sides.scene, sides.run, sides.result, sides.manifest, {},
                         {.compare = {.plots = true}});
  EXPECT_FALSE(std::filesystem::exists(plots / "friction.svg"));
  EXPECT_FALSE(std::filesystem::exists(plots / "friction.pdf"));
  EXPECT_TRUE(std::filesystem::exists(plots / "force-over-depth.svg"));
  EXPECT_EQ(scene::read_file(plots / "my-own.svg"), "old");
}

TEST(PlotFiles, EveryNameOfADrawingIsKnown) {
  testing::Sides sides = testing::pressed(4, 200);
  sides.scene.contact.friction = scene::Friction{1.0, 0.75, 0.5};
  const Errors errors = compute_errors(sides.scene, sides.run, sides.result.instants);
  std::vector<std::string> found{"stress"};  // drawn from a solved body: StressSection
  for (const Drawing& drawing : comparison_drawings(sides.scene, sides.run, sides.result, errors).all()) {
    found.push_back(drawing.name);
  }
  std::vector<std::string> known = ComparisonDrawings::names();
  std::sort(found.begin(), found.end());
  std::sort(known.begin(), known.end());
  EXPECT_EQ(found, known);
}

TEST(PlotFiles, PdfIsVectorsWithEmbeddedFontsInTheDrawingsSize) {
  if (!has_pdf()) GTEST_SKIP() << "built without librsvg";
  Plot plot;
  plot.title = "Force";
  plot.curves.push_back({"one", Look::reference, {0, 1, 2}, {0, 1, 4}});
  const std::string pdf = pdf_of(as_file(to_svg(plot, 560, 360)));
  EXPECT_TRUE(has(pdf, "/MediaBox [ 0 0 420 270 ]")) << pdf.substr(0, 2000);
  EXPECT_TRUE(has(pdf, "/FontFile"));
  EXPECT_FALSE(has(pdf, "/Subtype /Image"));
}

TEST(PlotFiles, WhatIsNoDrawingIsRefused) {
  if (!has_pdf()) GTEST_SKIP() << "built without librsvg";
  EXPECT_THROW((void)pdf_of("no drawing"), std::runtime_error);
}

}  // namespace
}  // namespace touchstone::compare
