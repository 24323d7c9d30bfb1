#include "study/statistics/table_reader.h"

#include <fmt/format.h>

#include <catch2/catch.hpp>

namespace conav::statistics {
namespace {

void Refuses(const std::string& text, const std::string& message) {
  const auto file = ParseTable(text, "t.csv");
  INFO(text);
  REQUIRE_FALSE(file);
  CHECK(file.error().code == ErrorCode::kMalformed);
  CHECK(file.error().text == message);
}

TEST_CASE("A table has a row per subject and a column per condition", "[operator][statistics]") {
  const auto file = ParseTable("subject,T1,T2\np1,1,2.5\np2,-3,4e2\n", "t.csv");
  REQUIRE(file);
  CHECK(file->table.conditions == std::vector<std::string>{"T1", "T2"});
  CHECK(file->table.subjects == std::vector<std::string>{"p1", "p2"});
  CHECK(file->table.values == std::vector<double>{1, 2.5, -3, 400});
  CHECK(file->table.At(1, 0) == -3);
  CHECK(ConditionValues(file->table, 1) == std::vector<double>{2.5, 400});
  CHECK(file->left_out.empty());
}

TEST_CASE("Line ends of Windows, a byte order mark, quotes, empty lines and signs are understood",
          "[operator][statistics]") {
  const auto file = ParseTable(
      "\xEF\xBB\xBF\"subject\",\"a, b\",\"c\"\r\n\r\n\"1\",\"+1\", 2 \r\n,,\r\n2,3,4", "t.csv");
  REQUIRE(file);
  CHECK(file->table.conditions[0] == "a, b");
  CHECK(file->table.values == std::vector<double>{1, 2, 3, 4});
}

TEST_CASE("A subject with an empty cell is left out and named", "[operator][statistics]") {
  const auto file = ParseTable("subject,a,b,c\np1,1,2,3\np2,1,,NA\np3,4,5,6\np4,,1,1\n", "t.csv");
  REQUIRE(file);
  CHECK(file->table.subjects == std::vector<std::string>{"p1", "p3"});
  REQUIRE(file->left_out.size() == 2);
  CHECK(file->left_out[0].subject == "p2");
  CHECK(file->left_out[0].line == 3);
  CHECK(file->left_out[0].missing == std::vector<std::string>{"b", "c"});
  CHECK(file->left_out[1].subject == "p4");
}

TEST_CASE("A header that is not one is refused", "[operator][statistics]") {
  const std::string form = "subject,<condition>,<condition>,...";
  Refuses("", "t.csv: is empty; the first line must be " + form);
  Refuses("id,a,b\n", "t.csv:1: begins with 'id'; the first line must be " + form);
  Refuses("subject;a;b\n", "t.csv:1: begins with 'subject;a;b'; the first line must be " + form +
                               " with commas between the columns");
  Refuses("subject,a\n", "t.csv:1: 1 condition after subject; 2 to 64 are possible");
  Refuses("subject,a,\n", "t.csv:1: column 3 has no name");
  Refuses("\nsubject,a,b,a\n", "t.csv:2: condition 'a' stands twice, in columns 2 and 4");
  std::string many = "subject";
  for (int i = 0; i < 65; ++i) many += fmt::format(",c{}", i);
  Refuses(many, "t.csv:1: 65 conditions after subject; 2 to 64 are possible");
}

TEST_CASE("A row that is not one is refused with its line and column", "[operator][statistics]") {
  const std::string start = "subject,a,b\np1,1,2\n";
  Refuses(start + "p2,1\n", "t.csv:3: column 'b' is missing: 2 columns instead of 3");
  Refuses(start + "p2\n", "t.csv:3: column 'a' is missing: 1 columns instead of 3");
  Refuses(start + "p2,1,5,2\n",
          "t.csv:3: 4 columns instead of 3 (decimals have a point, not a comma)");
  Refuses(start + ",1,2\n", "t.csv:3: column 'subject' is empty");
  Refuses(start + "p1,1,2\n", "t.csv:3: subject 'p1' stands twice, first in line 2");
  Refuses(start + "p2,1,\"2\n", "t.csv:3: a quote does not end");
}

TEST_CASE("What is not a finite number is refused", "[operator][statistics]") {
  const std::string start = "subject,a,b\np1,1,2\np2,1,";
  for (const char* wrong : {"x", "1.2.3", "1 2", "nan", "0x10", "--1", "+-1", "+"}) {
    Refuses(start + wrong, fmt::format("t.csv:3: column 'b': '{}' is not a number", wrong));
  }
  Refuses(start + "\"1,5\"", "t.csv:3: column 'b': '1,5' is not a number");
  for (const char* wrong : {"1e999", "inf", "-2e100", "1e-101", "1e-999"}) {
    Refuses(start + wrong,
            fmt::format("t.csv:3: column 'b': {} is out of range, 1e-100 to 1e+100 or 0", wrong));
  }
}

TEST_CASE("A subject that is left out cannot come again", "[operator][statistics]") {
  Refuses("subject,a,b\np1,,1\np1,1,2\n", "t.csv:3: subject 'p1' stands twice, first in line 2");
}

TEST_CASE("Two complete subjects are needed", "[operator][statistics]") {
  Refuses("subject,a,b\n",
          "t.csv: no subject with a value in every condition; at least 2 are needed");
  Refuses(
      "subject,a,b\np1,1,2\np2,,\n",
      "t.csv: 1 subject with a value in every condition; at least 2 are needed; p2 (line 3) has "
      "none in a, b");
}

TEST_CASE("Text that is not UTF-8 or has control characters is refused", "[operator][statistics]") {
  Refuses("subject,caf\xE9,b\n", "t.csv:1: is not UTF-8");
  Refuses("subject,a,b\np\x1B[1m,1,2\n",
          "t.csv:2: has a control character, byte 0x1b at position 2");
}

}  // namespace
}  // namespace conav::statistics
