#include <google/protobuf/stubs/logging.h>

#include <boost/beast/_experimental/test/stream.hpp>
#include <cstdint>
#include <fstream>

#include "common/runtime/result.h"
#include "operator/gateway/access.h"
#include "operator/gateway/http_connection.h"
#include "operator/gateway/page_feed.h"
#include "support/temporary_folder.h"

/// Whatever comes in over a connection: requests, upgrades, and the frames of a page, as the gateway
/// reads them, over a stream in memory.
///
/// Input: a byte, how many bytes come at a time (0 = as many as can); then the bytes.
namespace conav::operators {

using MemoryStream = beast::test::stream;

template <>
constexpr std::chrono::milliseconds kCloseLimit<MemoryStream>{20};
template <>
void LimitTime(MemoryStream&, std::chrono::seconds) {}
template <>
void LimitTimeNoLonger(MemoryStream&) {}
template <>
void EndSending(MemoryStream& stream) {
  stream.close();
}

namespace {

/// Takes what a page sends.
class Page final : public SocketFeed {
 public:
  explicit Page(const PageContext& context) : feed_(context, 1, Clock::TimePoint::clock::now()) {}

  void Take(std::string_view bytes, bool, Clock::TimePoint now) override {
    feed_.Take(bytes, now, 1000.0);
  }
  std::optional<SocketMessage> Next(Clock::TimePoint now) override {
    auto message = feed_.Next(now);
    if (!message) return std::nullopt;
    return SocketMessage{*std::move(message), nullptr, false};
  }
  std::optional<Clock::TimePoint> due() const override { return feed_.due(); }
  bool finished() const override { return feed_.finished(); }
  bool retry() const override { return feed_.retry(); }
  void End(std::string reason) override { feed_.End(std::move(reason)); }

 private:
  PageFeed feed_;
};

class Host final : public ConnectionHost, public SocketHost {
 public:
  explicit Host(const HttpRoutes& routes) : routes_(routes) {
    options_.message_burst = 1000;
    console::Update update;
    update.mutable_session()->set_name("fuzz");
    updates_.Put("session", update);
  }

  const GatewayOptions& options() const override { return options_; }
  SocketHost& host() override { return *this; }
  HttpResponse Answer(const HttpRequest& request) override { return routes_.Answer(request); }
  HttpResponse Refuse(unsigned status, const std::string& why) override {
    return HttpRoutes::Refuse(status, why);
  }
  std::optional<HttpResponse> RefuseSocket(const HttpRequest& request) override {
    const std::string why = WhyForeign(options_, request.host, request.origin);
    if (why.empty() && request.target == "/ws") return std::nullopt;
    return HttpRoutes::Refuse(403, why);
  }
  std::uint64_t Enter(const std::shared_ptr<SocketConnection>& page) override {
    page_ = page;
    return 1;
  }
  std::unique_ptr<SocketFeed> Open(std::uint64_t, const HttpRequest&) override {
    return std::make_unique<Page>(
        PageContext{options_, updates_, frames_, welcome_, access_, [] { return true; }});
  }
  void Leave(std::uint64_t) override { page_.reset(); }
  void CountMessage(bool, std::size_t) override {}
  void CountConnections(int) override {}
  void NoteRefused(const std::string&) override {}

  bool has_page() const { return page_ != nullptr; }

 private:
  const HttpRoutes& routes_;
  GatewayOptions options_;
  UpdateLog updates_;
  FrameSlots frames_;
  console::Welcome welcome_;
  AccessControl access_{""};
  std::shared_ptr<SocketConnection> page_;
};

/// What all connections are served with.
const HttpRoutes& Routes() {
  static const SnapshotStore snapshots(1000);
  static AccessControl access("");
  static const HttpRoutes routes = [] {
    const test::TemporaryFolder folder;
    std::ofstream(folder / "index.html") << "<page>";
    return HttpRoutes(
        {}, WebFiles(folder.path()),
        {snapshots, access, [] { return Readiness{}; }, [] { return std::string(); }});
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
  auto token = std::make_shared<OpenConnection>();
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
  // A connection ends with its client, or after kCloseLimit if it hangs while closing, and leaves nothing behind.
  if (token.use_count() > 1) io.run_for(std::chrono::seconds(4));
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
