#include <google/protobuf/stubs/logging.h>

#include <boost/beast/_experimental/test/stream.hpp>
#include <cstdint>
#include <fstream>

#include "common/runtime/result.h"
#include "operator/gateway/access.h"
#include "operator/gateway/http_connection.h"
#include "support/temporary_folder.h"

/// Whatever comes in over a connection: requests, upgrades, and the frames of a page, as the gateway
/// reads them, over a stream in memory.
///
/// Input: a byte, how many bytes come at a time (0 = as many as can); then the bytes.
namespace conav::operators {

using MemoryStream = beast::test::stream;

template <>
void LimitTime(MemoryStream&, std::chrono::seconds) {}
template <>
void LimitTimeNoLonger(MemoryStream&) {}
template <>
void EndSending(MemoryStream& stream) {
  stream.close();
}

namespace {

class Host final : public ConnectionHost {
 public:
  explicit Host(const HttpRoutes& routes) : routes_(routes) {
    options_.message_burst = 1000;
    console::Update update;
    update.mutable_session()->set_name("fuzz");
    updates_.Put("session", update);
  }

  const GatewayOptions& options() const override { return options_; }
  HttpResponse Answer(const HttpRequest& request) override { return routes_.Answer(request); }
  HttpResponse Refuse(unsigned status, const std::string& why) override {
    return HttpRoutes::Refuse(status, why);
  }
  std::optional<HttpResponse> RefusePage(const HttpRequest& request) override {
    const std::string why = WhyForeign(options_, request.host, request.origin);
    if (why.empty() && request.target == "/ws") return std::nullopt;
    return HttpRoutes::Refuse(403, why);
  }
  PageContext page_context() override {
    return {options_, updates_, frames_, welcome_, [] { return true; }};
  }
  std::uint64_t Enter(const std::shared_ptr<PageConnection>& page) override {
    page_ = page;
    return 1;
  }
  void Leave(std::uint64_t) override { page_.reset(); }
  bool Deliver(std::vector<PageEvent>) override { return true; }
  void CountMessage(bool, std::size_t) override {}
  void CountSkippedFrames(std::size_t) override {}

  bool has_page() const { return page_ != nullptr; }

 private:
  const HttpRoutes& routes_;
  GatewayOptions options_;
  UpdateLog updates_;
  FrameSlots frames_;
  console::Welcome welcome_;
  std::shared_ptr<PageConnection> page_;
};

/// What all connections are served with.
const HttpRoutes& Routes() {
  static const SnapshotStore snapshots(1000);
  static const HttpRoutes routes = [] {
    const test::TemporaryFolder folder;
    std::ofstream(folder / "index.html") << "<page>";
    return HttpRoutes({}, WebFiles(folder.path()),
                      {snapshots, [] { return Readiness{}; }, [] { return std::string(); }});
  }();
  return routes;
}

/// A client sends nothing behind an upgrade before it was answered: what follows a head comes later.
std::size_t SizeOfNext(std::string_view input, std::size_t piece) {
  constexpr std::string_view kEndOfHead = "\r\n\r\n";
  std::size_t size = piece == 0 ? input.size() : std::min(piece, input.size());
  const auto head = input.substr(0, size).find(kEndOfHead);
  return head == std::string_view::npos ? size : head + kEndOfHead.size();
}

void Serve(std::string_view input) {
  const std::size_t piece = input.empty() ? 0 : static_cast<std::uint8_t>(input.front());
  if (!input.empty()) input.remove_prefix(1);
  Host host(Routes());
  asio::io_context io;
  MemoryStream stream(io);
  MemoryStream client(io);
  stream.connect(client);
  auto token = std::make_shared<int>();
  std::make_shared<HttpConnection<MemoryStream>>(std::move(stream), host, token)->Start();
  while (!input.empty()) {
    const std::size_t size = SizeOfNext(input, piece);
    boost::system::error_code ended;
    client.write_some(asio::buffer(input.data(), size), ended);
    input.remove_prefix(size);
    io.poll();
  }
  client.close();
  io.restart();
  io.poll();
  // A connection ends when its client does, and leaves nothing behind.
  DEMAND(!host.has_page());
  DEMAND(token.use_count() == 1, token.use_count());
}

}  // namespace
}  // namespace conav::operators

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  google::protobuf::SetLogHandler(nullptr);  // it tells of each text that is no UTF-8
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  conav::operators::Serve({reinterpret_cast<const char*>(data), size});
  return 0;
}
