#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/runtime/result.h"

/// The part of OMG IDL in which conav's messages are written: `module PACKAGE { module msg { ... }; };`
/// with structs (of numbers, texts, other structs, arrays of one dimension, sequences) and constant
/// numbers. Whatever else there is in a file is refused by its line.
namespace conav::bag {

struct IdlField {
  std::string type;  // as ROS writes it: "uint8[]", "float64[36]", "std_msgs/Header"
  std::string name;
  std::string comment;  // behind it on its line
};

struct IdlStruct {
  std::string package;
  std::string name;
  std::vector<std::string> comment;  // the lines above it
  std::vector<IdlField> fields;
};

struct IdlConstant {
  std::string package;
  std::string type;
  std::string name;
  std::string value;
  std::string comment;
};

struct IdlDocument {
  std::vector<IdlStruct> structs;
  std::vector<IdlConstant> constants;
};

/// `text` may be several files behind one another, each after those that it includes; lines that
/// begin with '#' are left out. Errors: kMalformed "line N: ...": what was expected, and what is
/// there.
[[nodiscard]] Result<IdlDocument> ParseIdl(std::string_view text);

}  // namespace conav::bag
