// SPDX-License-Identifier: BSD-3-Clause
#include <arpa/inet.h>
#include <libwebsockets.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <deque>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "view/messages.hpp"

namespace rio::view {

namespace {

using Json = nlohmann::json;

constexpr std::size_t kMostWaiting = 4 << 20;  // bytes, of the run and of each viewer
constexpr std::size_t kMostRequest = 1 << 16;  // bytes of one request
constexpr std::size_t kMostViewers = 8;
constexpr std::size_t kMostSubscriptions = 1024;

struct Message {
  std::uint16_t channel = 0;
  std::uint64_t time = 0;
  std::shared_ptr<const std::string> payload;
};

struct Channel {
  Json advertised;
  Message latest;  ///< for later viewers
};

/// One message to a viewer: text, or data with the subscription.
struct Outgoing {
  bool text = false;
  std::string bytes;  ///< behind LWS_PRE bytes of room
};

struct Viewer {
  std::map<std::uint32_t, std::uint16_t> subscriptions;  ///< channel by the viewer's number
  std::deque<Outgoing> waiting;
  std::size_t waiting_bytes = 0;
  std::size_t told_channels = 0;
  std::string request;  ///< so far received
};

class Server : public LiveServer {
 public:
  Server(const std::string& address, int port) {
    static const lws_protocols kProtocols[] = {
        {"foxglove.websocket.v1", &Server::callback, 0, 4096, 0, nullptr, 0},
        {nullptr, nullptr, 0, 0, 0, nullptr, 0}};
    lws_set_log_level(0, nullptr);
    lws_context_creation_info info{};
    info.port = port;
    info.iface = address.c_str();
    info.protocols = kProtocols;
    info.user = this;
    info.gid = static_cast<decltype(info.gid)>(-1);
    info.uid = static_cast<decltype(info.uid)>(-1);
    info.options = LWS_SERVER_OPTION_FAIL_UPON_UNABLE_TO_BIND;
    // with IPv6 on, an IPv4 address is not found and every interface is taken
    in_addr v4{};
    const bool is_v4 = inet_pton(AF_INET, address.c_str(), &v4) == 1;
    if (is_v4) info.options |= LWS_SERVER_OPTION_DISABLE_IPV6;
    context_ = lws_create_context(&info);
    if (context_ == nullptr) {
      throw std::runtime_error("--view: cannot listen on " + address + ":" + std::to_string(port));
    }
    lws_vhost* const host = lws_get_vhost_by_name(context_, "default");
    port_ = host != nullptr ? lws_get_vhost_listen_port(host) : port;
    thread_ = std::thread([this] {
      while (!stop_) lws_service(context_, 0);
    });
  }
  ~Server() override {
    stop_ = true;
    lws_cancel_service(context_);
    thread_.join();
    lws_context_destroy(context_);
  }

  int port() const override { return port_; }
  std::uint64_t dropped() const override { return dropped_; }

  std::uint16_t add_channel(const std::string& topic, const std::string& type,
                            const std::string& definition) override {
    const std::lock_guard lock(mutex_);
    const auto id = static_cast<std::uint16_t>(channels_.size());
    channels_.push_back({{{"id", id},
                          {"topic", topic},
                          {"encoding", "cdr"},
                          {"schemaName", type},
                          {"schema", definition},
                          {"schemaEncoding", "ros2msg"}},
                         {}});
    return id;
  }

  void add(std::uint16_t channel, Time time, std::string_view message) override {
    Message queued{channel, static_cast<std::uint64_t>(time.count()),
                   std::make_shared<const std::string>(message)};
    const std::lock_guard lock(mutex_);
    if (queue_bytes_ + message.size() > kMostWaiting) {
      ++dropped_;
      return;
    }
    queue_bytes_ += message.size();
    queue_.push_back(std::move(queued));
  }

  void flush(Time /*time*/) override { lws_cancel_service(context_); }

  void close() override {
    flush(Time{0});
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(1);
    while (unsent_ > 0 && std::chrono::steady_clock::now() < end) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }

 private:
  void push(Viewer* viewer, bool text, const std::string& bytes) {
    viewer->waiting.push_back({text, std::string(LWS_PRE, '\0') + bytes});
    viewer->waiting_bytes += viewer->waiting.back().bytes.size();
    ++unsent_;
    while (viewer->waiting_bytes > kMostWaiting) {
      // what describes the channels stays; of data the oldest goes
      const auto newest = viewer->waiting.end() - 1;
      const auto oldest = std::find_if(viewer->waiting.begin(), newest,
                                       [](const Outgoing& message) { return !message.text; });
      if (oldest == newest) return;
      viewer->waiting_bytes -= oldest->bytes.size();
      viewer->waiting.erase(oldest);
      ++dropped_;
      --unsent_;
    }
  }

  void push_data(Viewer* viewer, std::uint32_t subscription, const Message& message) {
    bag::ByteWriter head;
    head.put(std::uint8_t{1}).put(subscription).put(message.time);
    push(viewer, false, head.bytes() + *message.payload);
  }

  /// Under the mutex.
  void tell_channels(Viewer* viewer) {
    if (viewer->told_channels == channels_.size()) return;
    Json list = Json::array();
    for (; viewer->told_channels < channels_.size(); ++viewer->told_channels) {
      list.push_back(channels_[viewer->told_channels].advertised);
    }
    push(viewer, true, Json{{"op", "advertise"}, {"channels", list}}.dump());
  }

  /// Hands what the run has queued to the viewers.
  void distribute() {
    std::deque<Message> messages;
    {
      const std::lock_guard lock(mutex_);
      messages.swap(queue_);
      queue_bytes_ = 0;
      for (const Message& message : messages) channels_[message.channel].latest = message;
      for (auto& [wsi, viewer] : viewers_) tell_channels(&viewer);
    }
    for (auto& [wsi, viewer] : viewers_) {
      for (const Message& message : messages) {
        for (const auto& [subscription, channel] : viewer.subscriptions) {
          if (channel == message.channel) push_data(&viewer, subscription, message);
        }
      }
      if (!viewer.waiting.empty()) lws_callback_on_writable(wsi);
    }
  }

  /// @return 0; -1: disconnect
  int greet(lws* wsi) {
    if (viewers_.size() >= kMostViewers) return -1;
    Viewer& viewer = viewers_[wsi];
    const Json info = {{"op", "serverInfo"},
                       {"name", "rio"},
                       {"capabilities", Json::array()},
                       {"supportedEncodings", {"cdr"}}};
    push(&viewer, true, info.dump());
    const std::lock_guard lock(mutex_);
    tell_channels(&viewer);
    lws_callback_on_writable(wsi);
    return 0;
  }

  void subscribe(Viewer* viewer, const Json& wanted) {
    const Json id = wanted.value("id", Json());
    const Json channel = wanted.value("channelId", Json());
    if (!id.is_number_unsigned() || !channel.is_number_unsigned()) return;
    if (viewer->subscriptions.size() >= kMostSubscriptions) return;
    const std::lock_guard lock(mutex_);
    const auto c = channel.get<std::uint64_t>();
    if (c >= channels_.size() || id.get<std::uint64_t>() > UINT32_MAX) return;
    const auto subscription = id.get<std::uint32_t>();
    viewer->subscriptions[subscription] = static_cast<std::uint16_t>(c);
    if (channels_[c].latest.payload) push_data(viewer, subscription, channels_[c].latest);
  }

  /// A request that is not understood changes nothing.
  void take_request(Viewer* viewer) {
    const Json request = Json::parse(viewer->request, nullptr, false);
    viewer->request.clear();
    if (!request.is_object() || !request.value("op", Json()).is_string()) return;
    const std::string op = request["op"];
    const Json wanted =
        request.value(op == "subscribe" ? "subscriptions" : "subscriptionIds", Json());
    if (!wanted.is_array()) return;
    for (const Json& one : wanted) {
      if (op == "subscribe" && one.is_object()) subscribe(viewer, one);
      if (op == "unsubscribe" && one.is_number_unsigned()) {
        viewer->subscriptions.erase(one.get<std::uint32_t>());
      }
    }
  }

  /// @return 0; -1: disconnect
  int receive(lws* wsi, const void* bytes, std::size_t count) {
    Viewer& viewer = viewers_[wsi];
    if (lws_frame_is_binary(wsi) != 0) return 0;  // publishes to us: not offered
    if (viewer.request.size() + count > kMostRequest) return -1;
    viewer.request.append(static_cast<const char*>(bytes), count);
    if (lws_is_final_fragment(wsi) != 0 && lws_remaining_packet_payload(wsi) == 0) {
      take_request(&viewer);
    }
    if (!viewer.waiting.empty()) lws_callback_on_writable(wsi);
    return 0;
  }

  int write(lws* wsi) {
    Viewer& viewer = viewers_[wsi];
    if (viewer.waiting.empty()) return 0;
    Outgoing next = std::move(viewer.waiting.front());
    viewer.waiting.pop_front();
    viewer.waiting_bytes -= next.bytes.size();
    --unsent_;
    auto* const data = reinterpret_cast<unsigned char*>(next.bytes.data()) + LWS_PRE;
    const std::size_t count = next.bytes.size() - LWS_PRE;
    if (lws_write(wsi, data, count, next.text ? LWS_WRITE_TEXT : LWS_WRITE_BINARY) < 0) return -1;
    if (!viewer.waiting.empty()) lws_callback_on_writable(wsi);
    return 0;
  }

  void leave(lws* wsi) {
    unsent_ -= viewers_[wsi].waiting.size();
    viewers_.erase(wsi);
  }

  static int callback(lws* wsi, lws_callback_reasons reason, void* /*user*/, void* in,
                      std::size_t count) {
    auto* const self = static_cast<Server*>(lws_context_user(lws_get_context(wsi)));
    if (reason == LWS_CALLBACK_ESTABLISHED) return self->greet(wsi);
    if (reason == LWS_CALLBACK_RECEIVE) return self->receive(wsi, in, count);
    if (reason == LWS_CALLBACK_SERVER_WRITEABLE) return self->write(wsi);
    if (reason == LWS_CALLBACK_CLOSED) self->leave(wsi);
    if (reason == LWS_CALLBACK_EVENT_WAIT_CANCELLED) self->distribute();
    return reason == LWS_CALLBACK_HTTP ? -1 : 0;  // no pages here
  }

  // shared by the run and the server's thread
  std::mutex mutex_;
  std::deque<Message> queue_;
  std::size_t queue_bytes_ = 0;
  std::vector<Channel> channels_;
  std::atomic<std::uint64_t> dropped_{0};
  std::atomic<bool> stop_{false};
  std::atomic<std::size_t> unsent_{0};  ///< messages that wait for viewers
  lws_context* context_ = nullptr;
  int port_ = 0;
  std::thread thread_;

  std::map<lws*, Viewer> viewers_;  ///< of the server's thread
};

}  // namespace

std::unique_ptr<LiveServer> make_live_server(const std::string& address, int port) {
  return std::make_unique<Server>(address, port);
}

}  // namespace rio::view
