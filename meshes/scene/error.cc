#include "scene/error.h"

#include <utility>

namespace touchstone::scene {
namespace {

std::string join(const std::vector<Fault>& faults) {
  std::string text;
  for (const Fault& fault : faults) {
    if (!text.empty()) text += '\n';
    text += fault.text();
  }
  return text;
}

}  // namespace

std::string Fault::text() const {
  std::string place = file;
  if (line > 0) place += ":" + std::to_string(line);
  if (line > 0 && column > 0) place += ":" + std::to_string(column);
  return place.empty() ? message : place + ": " + message;
}

InputError::InputError(std::vector<Fault> faults) : std::runtime_error(join(faults)), faults_(std::move(faults)) {}

InputError::InputError(const std::string& message) : InputError(std::vector<Fault>{{"", 0, 0, message}}) {}

}  // namespace touchstone::scene
