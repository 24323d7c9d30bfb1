#pragma once

#include <cstdint>
#include <string>
#include <variant>

#include "console.pb.h"

namespace conav::operators {

/// Who sits at a page, once it has said hello.
struct PageIdentity {
  std::string client;  // as in OperatorRequest::client: "<name>/<instance>"
  std::string name;    // as typed
  console::Role role = console::ROLE_OBSERVER;
};

struct PageJoined {};
struct PageLeft {};
/// Somebody used the page, whether or not that asked for anything.
struct PageUsed {};
struct PageAsked {
  console::Request request;
  double round_trip_s = 0.0;  // as the page measured last; 0 = never
};

/// What a page did. `page` is one connection; a page that comes back is another one.
struct PageEvent {
  std::uint64_t page = 0;
  PageIdentity who;
  std::variant<PageJoined, PageLeft, PageUsed, PageAsked, console::Seek> body;
};

}  // namespace conav::operators
