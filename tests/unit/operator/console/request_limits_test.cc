#include <catch2/catch.hpp>
#include <string>

#include "console.pb.h"
#include "operator/console/command_log.h"

namespace conav::operators {
namespace {

constexpr std::size_t kMessage = 512 * 1024;

void Write(console::Cell* cell) {
  cell->set_row(1023);
  cell->set_column(1023);
}

console::ClientMessage MessageOf(console::Request request) {
  console::ClientMessage message;
  request.set_id(~std::uint64_t{0});
  request.set_valid_until(1e9);
  request.set_world(std::string(64, 'w'));
  *message.mutable_request() = std::move(request);
  return message;
}

TEST_CASE("An edit and a path of as many cells as allowed fit into a message",
          "[operator][console]") {
  const RequestLimits limits = LimitsOf(kMessage, {65536, 65536});
  console::Request edit;
  edit.mutable_edit()->set_base_revision(~std::uint64_t{0});
  for (std::uint32_t i = 0; i < limits.edit_cells; ++i) {
    console::CellEdit* cell = edit.mutable_edit()->add_cells();
    cell->set_wall(true);
    Write(cell->mutable_cell());
  }
  CHECK(MessageOf(edit).ByteSizeLong() <= kMessage);
  console::Request guide;
  guide.mutable_guide()->set_robot(std::string(64, 'r'));
  for (std::uint32_t i = 0; i < limits.path_cells; ++i) Write(guide.mutable_guide()->add_path());
  CHECK(MessageOf(guide).ByteSizeLong() <= kMessage);
  CHECK(limits.edit_cells > 40'000);  // all of a map of 150 x 150 twice over
}

TEST_CASE("What else limits a request counts, too", "[operator][console]") {
  CHECK(LimitsOf(kMessage, {100, 200}) == RequestLimits{100, 200});
  CHECK(LimitsOf(100, {100, 200}) == RequestLimits{0, 0});
}

}  // namespace
}  // namespace conav::operators
