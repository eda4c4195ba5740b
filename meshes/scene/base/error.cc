#include "scene/base/error.h"

#include "scene/base/text.h"

#include <algorithm>
#include <utility>

namespace touchstone::scene {
namespace {

std::string join(const std::vector<Fault>& faults) {
  std::string text;
  for (std::size_t i = 0; i < std::min(faults.size(), faults_shown_max); ++i) {
    if (i > 0) text += '\n';
    text += faults[i].text();
  }
  if (faults.size() > faults_shown_max) {
    const std::size_t more = faults.size() - faults_shown_max;
    text += "\nand " + std::to_string(more) + (more == 1 ? " more fault" : " more faults");
  }
  return text;
}

}  // namespace

std::string Fault::text() const {
  constexpr std::size_t message_bytes_max = 2000;
  std::string place = visible(shortened(file, 1000));
  if (line > 0) place += ":" + std::to_string(line);
  if (line > 0 && column > 0) place += ":" + std::to_string(column);
  const std::string told = visible(shortened(message, message_bytes_max));
  return place.empty() ? told : place + ": " + told;
}

InputError::InputError(std::vector<Fault> faults) : std::runtime_error(join(faults)), faults_(std::move(faults)) {}

InputError::InputError(const std::string& message) : InputError(std::vector<Fault>{{"", 0, 0, message}}) {}

}  // namespace touchstone::scene
