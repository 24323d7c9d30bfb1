#include <catch2/catch.hpp>

#include "study/statistics/table_reader.h"

namespace conav::statistics {
namespace {

using Fields = std::vector<std::string>;

TEST_CASE("A row is cut at its commas, without the spaces around them", "[operator][statistics]") {
  CHECK(*SplitCsvRow("") == Fields{""});
  CHECK(*SplitCsvRow("a") == Fields{"a"});
  CHECK(*SplitCsvRow(" a ,\tb b,c") == Fields{"a", "b b", "c"});
  CHECK(*SplitCsvRow("a,,") == Fields{"a", "", ""});
}

TEST_CASE("Between quotes a comma is a comma and two quotes are one", "[operator][statistics]") {
  CHECK(*SplitCsvRow("\"a,b\", \"c \"\"d\"\"\" ,e") == Fields{"a,b", "c \"d\"", "e"});
  CHECK(*SplitCsvRow("\"\",\" 1.5\"") == Fields{"", "1.5"});
}

TEST_CASE("A quote that does not end, or not at a comma, is refused", "[operator][statistics]") {
  CHECK(SplitCsvRow("a,\"b").error().text == "a quote does not end");
  CHECK(SplitCsvRow("\"a\"b,c").error().text == "after a quoted field a comma must follow");
}

}  // namespace
}  // namespace conav::statistics
