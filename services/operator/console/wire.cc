#include "operator/console/wire.h"

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>
#include <google/protobuf/wire_format_lite.h>

namespace conav::operators {
namespace {

using google::protobuf::internal::WireFormatLite;
using google::protobuf::io::CodedOutputStream;
using google::protobuf::io::StringOutputStream;

/// Tag and length of a message in field `field`.
void WriteHead(CodedOutputStream& out, int field, std::size_t length) {
  out.WriteTag(WireFormatLite::MakeTag(field, WireFormatLite::WIRETYPE_LENGTH_DELIMITED));
  out.WriteVarint32(static_cast<std::uint32_t>(length));
}

}  // namespace

std::string EncodeUpdate(const console::Update& update) {
  std::string encoded;
  StringOutputStream stream(&encoded);
  CodedOutputStream out(&stream);
  WriteHead(out, console::Updates::kUpdateFieldNumber, update.ByteSizeLong());
  update.SerializeWithCachedSizes(&out);
  out.Trim();
  return encoded;
}

std::string EncodeUpdates(std::string_view updates, bool everything) {
  console::Updates flags;
  flags.set_everything(everything);
  const std::string flag_bytes = flags.SerializeAsString();
  std::string encoded;
  StringOutputStream stream(&encoded);
  CodedOutputStream out(&stream);
  WriteHead(out, console::ServerMessage::kUpdatesFieldNumber, updates.size() + flag_bytes.size());
  out.WriteRaw(updates.data(), static_cast<int>(updates.size()));
  out.WriteRaw(flag_bytes.data(), static_cast<int>(flag_bytes.size()));
  out.Trim();
  return encoded;
}

std::string Encode(const console::ServerMessage& message) { return message.SerializeAsString(); }

Result<console::ClientMessage> DecodeClientMessage(std::string_view bytes) {
  console::ClientMessage message;
  if (!message.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) {
    return Fail(ErrorCode::kMalformed,
                "a message of " + std::to_string(bytes.size()) + " bytes is no ClientMessage");
  }
  if (message.body_case() == console::ClientMessage::BODY_NOT_SET) {
    return Fail(ErrorCode::kMalformed, "a ClientMessage without a body");
  }
  return message;
}

}  // namespace conav::operators
