#include "support/xml.h"

#include <vtkNew.h>
#include <vtkObject.h>
#include <vtkXMLParser.h>

#include <regex>

namespace touchstone::compare::testing {

bool is_well_formed(const std::string& xml) {
  vtkObject::GlobalWarningDisplayOff();
  vtkNew<vtkXMLParser> parser;
  return parser->Parse(xml.c_str(), static_cast<unsigned int>(xml.size())) != 0;
}

bool shows_not_a_number(const std::string& text) {
  static const std::regex pattern("(^|[^A-Za-z])-?(nan|inf)([^A-Za-z]|$)", std::regex::icase);
  return std::regex_search(text, pattern);
}

std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

}  // namespace touchstone::compare::testing
