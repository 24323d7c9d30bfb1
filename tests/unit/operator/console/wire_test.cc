#include <catch2/catch.hpp>

#include "operator/console/console_messages.h"
#include "unit/operator/support/updates.h"

namespace conav::operators {

TEST_CASE("encoded updates one behind the other are one message", "[operator][console]") {
  const bool everything = GENERATE(false, true);
  const std::vector<console::Update> sent{Said("a", "first"), Said("b", std::string(300, 'x')),
                                          console::Update()};
  std::string body;
  for (const console::Update& update : sent) body += EncodeUpdate(update);
  console::ServerMessage message;
  REQUIRE(message.ParseFromString(EncodeUpdates(body, everything)));
  REQUIRE(message.has_updates());
  CHECK(message.updates().everything() == everything);
  REQUIRE(message.updates().update_size() == 3);
  for (int i = 0; i < 3; ++i) {
    CHECK(message.updates().update(i).SerializeAsString() ==
          sent[static_cast<std::size_t>(i)].SerializeAsString());
  }
}

TEST_CASE("no updates are a message, too", "[operator][console]") {
  console::ServerMessage message;
  REQUIRE(message.ParseFromString(EncodeUpdates("", false)));
  CHECK(message.has_updates());
  CHECK(message.updates().update().empty());
}

TEST_CASE("a message to the page is protobuf's", "[operator][console]") {
  console::ServerMessage message;
  message.mutable_reply()->set_id(7);
  CHECK(Encode(message) == message.SerializeAsString());
}

TEST_CASE("a page's message is read", "[operator][console]") {
  console::ClientMessage message;
  message.mutable_ping()->set_page_time(2.5);
  const auto decoded = DecodeClientMessage(message.SerializeAsString());
  REQUIRE(decoded);
  CHECK(decoded->ping().page_time() == 2.5);
}

TEST_CASE("what is no message of a page is refused", "[operator][console]") {
  console::ClientMessage without_utf8;
  without_utf8.mutable_hello()->set_name("\xFF");
  const std::string bytes =
      GENERATE_COPY(std::string(), std::string("\xFF\xFF\xFF", 3), std::string("\x0A\x7F", 2),
                    without_utf8.SerializeAsString());
  const auto decoded = DecodeClientMessage(bytes);
  REQUIRE_FALSE(decoded);
  CHECK(decoded.error().code == ErrorCode::kMalformed);
}

}  // namespace conav::operators
