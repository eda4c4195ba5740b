// Compares the report of extremes with the comments of the tests in this program's folder.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "support/source_folder.h"

namespace {

const std::filesystem::path source = touchstone::source_folder();
const std::filesystem::path folder = source / EXTREMES_FOLDER, report_file = source / EXTREMES_REPORT;

/// The comment above a test: "// extreme: what holds." and, for the fast model, "// As printed: the published method's
/// result."
struct Row {
  std::string test, extreme, holds, printed;
};
struct Chapter {
  std::string title;
  std::vector<Row> rows;
};

/// Whether the tests are of the printed method, too.
const bool with_printed = std::string(EXTREMES_FOLDER) == "tests/extremes";

std::string read(const std::filesystem::path& path) {
  std::ifstream in(path);
  EXPECT_TRUE(in) << path;
  return (std::ostringstream() << in.rdbuf()).str();
}

std::string capital(std::string text) {
  if (!text.empty()) text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

Row row_of(const std::string& test, const std::string& comment) {
  const std::string mark = " As printed: ";
  const std::size_t colon = comment.find(": "), printed = std::min(comment.find(mark), comment.size());
  EXPECT_LT(colon, printed) << test << " says: " << comment;
  EXPECT_EQ(printed < comment.size(), with_printed) << test << " says: " << comment;
  if (colon >= printed || (printed < comment.size()) != with_printed) return {test, {}, {}, {}};
  return {test, comment.substr(0, colon), capital(comment.substr(colon + 2, printed - colon - 2)),
          with_printed ? comment.substr(printed + mark.size()) : ""};
}

Chapter chapter_of(const std::filesystem::path& path) {
  Chapter chapter;
  std::istringstream lines(read(path));
  std::string comment;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("// ")) {
      comment += (comment.empty() ? "" : " ") + line.substr(3);
      continue;
    }
    if (chapter.title.empty()) {
      const std::string start = "The extremes: ";
      EXPECT_TRUE(comment.starts_with(start) && comment.ends_with(".")) << path << " starts: " << comment;
      chapter.title = capital(comment.substr(start.size(), comment.size() - start.size() - 1));
    }
    if (line.starts_with("TEST(")) {
      const std::size_t comma = line.find(", "), end = line.find(')');
      chapter.rows.push_back(
          row_of(line.substr(5, comma - 5) + "." + line.substr(comma + 2, end - comma - 2), comment));
    }
    comment.clear();
  }
  return chapter;
}

std::vector<Chapter> catalogue() {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename();
    if (name.ends_with("_test.cc") && name != "catalogue_test.cc") paths.push_back(entry.path());
  }
  std::sort(paths.begin(), paths.end());
  std::vector<Chapter> chapters;
  std::transform(paths.begin(), paths.end(), std::back_inserter(chapters), chapter_of);
  return chapters;
}

std::string table(const std::vector<Chapter>& chapters) {
  std::ostringstream out;
  for (const Chapter& chapter : chapters) {
    out << "\n## " << chapter.title << "\n\n| test | extreme | what holds |"
        << (with_printed ? " as printed |\n|---|---|---|---|\n" : "\n|---|---|---|\n");
    for (const Row& row : chapter.rows) {
      out << "| `" << row.test << "` | " << row.extreme << " | " << row.holds << " |"
          << (with_printed ? " " + row.printed + " |" : "") << "\n";
    }
  }
  return out.str();
}

TEST(Catalogue, NamesEveryTestAndNoOther) {
  std::vector<std::string> named, run;
  for (const Chapter& chapter : catalogue())
    for (const Row& row : chapter.rows) named.push_back(row.test);
  const testing::UnitTest& all = *testing::UnitTest::GetInstance();
  for (int s = 0; s < all.total_test_suite_count(); ++s) {
    const testing::TestSuite& suite = *all.GetTestSuite(s);
    if (std::string(suite.name()) == "Catalogue") continue;
    for (int t = 0; t < suite.total_test_count(); ++t)
      run.push_back(std::string(suite.name()) + "." + suite.GetTestInfo(t)->name());
  }
  std::sort(named.begin(), named.end());
  std::sort(run.begin(), run.end());
  EXPECT_EQ(named, run);
  EXPECT_GE(run.size(), 10u);
}

TEST(Catalogue, IsTheReport) {
  const std::string report = read(report_file), wanted = table(catalogue());
  const std::size_t tables = report.find("\n## ");
  if (tables != std::string::npos && report.substr(tables) == wanted) return;
  const std::string path = testing::TempDir() + report_file.filename().string();
  std::ofstream(path) << report.substr(0, tables) << wanted;
  ADD_FAILURE() << EXTREMES_REPORT << " differs from the tests' comments; the right one: " << path;
}

}  // namespace
