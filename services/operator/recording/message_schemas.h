#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/runtime/result.h"

// One user: the recorder; the schemas are tested without it.

/// The part of OMG IDL in which conav's messages are written: `module PACKAGE { module msg { ... };
/// };` with structs (of numbers, texts, other structs, arrays of one dimension, sequences) and
/// constant numbers. Anything else is rejected; the error names the line.
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

/// The definitions of message types as ROS 2 writes them in .msg files and as MCAP's schema
/// encoding "ros2msg" has them, not as "ros2idl" (the IDL as it is), which Foxglove and Lichtblick
/// read but mcap-ros2-support for Python and PlotJuggler's ROS parser do not: the type's fields,
/// then, behind a line of '=' and "MSG: package/Name", those of every type that it is made of.
///
/// ROS keeps constants in the message that uses them, our IDL outside the structs: a field whose
/// comment names constants ("COMMAND_KIND_*", or one by its whole name) gets them in the lines
/// before it, where Foxglove takes them for the names of its values.
class MessageSchemas {
 public:
  explicit MessageSchemas(IdlDocument idl);

  /// Of "conav_msgs/msg/RobotState". Errors: kNotFound.
  [[nodiscard]] Result<std::string> TextOf(const std::string& type) const;

  /// "conav_msgs/msg/RobotState", ..., in the order of the IDL.
  std::vector<std::string> types() const;

 private:
  const IdlStruct* Find(const std::string& package_and_name) const;
  void AppendFields(const IdlStruct& type, std::string& text) const;
  void AppendDependencies(const IdlStruct& type, std::vector<const IdlStruct*>& all) const;

  IdlDocument idl_;
};

/// Of idl/: every type of a topic. Read from the text that the program was built with.
const MessageSchemas& ConavSchemas();

}  // namespace conav::bag
