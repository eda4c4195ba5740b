// A study file for one test, and the message about a faulty one.
#pragma once

#include "scene/base/error.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace touchstone::compare {

class StudyFileTest : public testing::Test {
 protected:
  ~StudyFileTest() override { std::filesystem::remove(file_); }

  /// The test's file with this text in it.
  const std::filesystem::path& written(const std::string& text) {
    std::ofstream(file_) << text;
    return file_;
  }
  /// The message with which `load` refuses a file, without the file's name; "accepted" if it does not.
  template <class Load>
  std::string refusal_of(const Load& load) {
    try {
      load();
    } catch (const scene::InputError& error) {
      std::string message = error.what();
      for (std::size_t at; (at = message.find(file_.string() + ":")) != std::string::npos;) {
        message.erase(at, file_.string().size() + 1);
      }
      return message;
    }
    return "accepted";
  }

  const std::filesystem::path file_ =
      std::filesystem::temp_directory_path() / ("study-" + std::to_string(::getpid()) + ".toml");
};

}  // namespace touchstone::compare
