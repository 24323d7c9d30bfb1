#pragma once

#include <string>
#include <string_view>

#include "common/runtime/result.h"
#include "console.pb.h"

/// idl/console.proto as bytes. An update is encoded once, however many pages get it: encoded updates
/// one behind the other are the body of a console::Updates.
namespace conav::operators {

/// `update` as an element of console::Updates.update.
std::string EncodeUpdate(const console::Update& update);

/// A console::ServerMessage with the updates of UpdateLog::Batch; `everything` as in the schema.
std::string EncodeUpdates(std::string_view updates, bool everything);

std::string Encode(const console::ServerMessage& message);

/// Errors: kMalformed.
[[nodiscard]] Result<console::ClientMessage> DecodeClientMessage(std::string_view bytes);

}  // namespace conav::operators
