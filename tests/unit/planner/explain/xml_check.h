#pragma once

#include <boost/property_tree/ptree.hpp>
#include <boost/property_tree/xml_parser.hpp>
#include <sstream>
#include <string>

namespace conav::test {

/// What is wrong with `text` as XML; empty when it is well-formed.
inline std::string XmlError(const std::string& text) {
  std::istringstream stream(text);
  boost::property_tree::ptree tree;
  try {
    boost::property_tree::read_xml(stream, tree);
  } catch (const boost::property_tree::xml_parser_error& error) {
    return error.what();
  }
  return "";
}

}  // namespace conav::test
