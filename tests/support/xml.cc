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

}  // namespace touchstone::compare::testing
