// SPDX-License-Identifier: BSD-3-Clause
#include "view/live_server.hpp"

#include <libwebsockets.h>

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

namespace rio::view {

namespace {

using Json = nlohmann::json;
using Bytes = std::shared_ptr<const std::string>;  // behind LWS_PRE bytes of room

constexpr const char* kProtocol = "foxglove.websocket.v1";
constexpr std::size_t kMostWaiting = 4 << 20;  // bytes, of the run and of each viewer
constexpr std::size_t kMostRequest = 1 << 16;  // bytes of one request
constexpr std::size_t kMostViewers = 8;
constexpr std::size_t kMostSubscriptions = 1024;

std::string with_room(std::string_view text) {
  std::string bytes(LWS_PRE, '\0');
  bytes += text;
  return bytes;
}

struct Message {
  std::uint16_t channel = 0;
  std::uint64_t time = 0;
  Bytes payload;
};

struct Channel {
  Json advertised;
  bool latest_stays = false;
  Message latest;  ///< if it stays
};

/// One message to a viewer: text, or data with the subscription.
struct Outgoing {
  bool text = false;
  std::string bytes;
};

struct Viewer {
  std::map<std::uint32_t, std::uint16_t> subscriptions;  ///< channel by the viewer's number
  std::deque<Outgoing> waiting;
  std::size_t waiting_bytes = 0;
  std::size_t told_channels = 0;
  std::string request;  ///< so far received
};

}  // namespace

struct LiveServer::Impl {
  // shared by the run and the server's thread
  std::mutex mutex;
  std::deque<Message> queue;
  std::size_t queue_bytes = 0;
  std::vector<Channel> channels;

  std::atomic<std::uint64_t> dropped{0};
  std::atomic<bool> stop{false};
  std::atomic<std::size_t> unsent{0};  ///< messages that wait for viewers
  lws_context* context = nullptr;
  int port = 0;
  std::thread thread;

  // of the server's thread
  std::map<lws*, Viewer> viewers;

  void push(Viewer* viewer, bool text, std::string bytes) {
    viewer->waiting_bytes += bytes.size();
    viewer->waiting.push_back({text, std::move(bytes)});
    ++unsent;
    // what describes the channels stays; of data the oldest goes
    for (auto at = viewer->waiting.begin();
         viewer->waiting_bytes > kMostWaiting && at + 1 != viewer->waiting.end();) {
      if (at->text) {
        ++at;
        continue;
      }
      viewer->waiting_bytes -= at->bytes.size();
      at = viewer->waiting.erase(at);
      ++dropped;
      --unsent;
    }
  }

  void push_data(Viewer* viewer, std::uint32_t subscription, const Message& message) {
    bag::ByteWriter head;
    head.put(std::uint8_t{1}).put(subscription).put(message.time);
    push(viewer, false, with_room(head.bytes() + *message.payload));
  }

  /// Under the mutex.
  void tell_channels(Viewer* viewer) {
    if (viewer->told_channels == channels.size()) return;
    Json list = Json::array();
    for (; viewer->told_channels < channels.size(); ++viewer->told_channels) {
      list.push_back(channels[viewer->told_channels].advertised);
    }
    push(viewer, true, with_room(Json{{"op", "advertise"}, {"channels", list}}.dump()));
  }

  /// Hands what the run has queued to the viewers.
  void distribute() {
    std::deque<Message> messages;
    {
      const std::lock_guard lock(mutex);
      messages.swap(queue);
      queue_bytes = 0;
      for (auto& [wsi, viewer] : viewers) tell_channels(&viewer);
    }
    for (auto& [wsi, viewer] : viewers) {
      for (const Message& message : messages) {
        for (const auto& [subscription, channel] : viewer.subscriptions) {
          if (channel == message.channel) push_data(&viewer, subscription, message);
        }
      }
      if (!viewer.waiting.empty()) lws_callback_on_writable(wsi);
    }
  }

  void greet(lws* wsi) {
    Viewer& viewer = viewers[wsi];
    const Json info = {{"op", "serverInfo"},
                       {"name", "rio"},
                       {"capabilities", Json::array()},
                       {"supportedEncodings", {"cdr"}}};
    push(&viewer, true, with_room(info.dump()));
    const std::lock_guard lock(mutex);
    tell_channels(&viewer);
  }

  void subscribe(Viewer* viewer, const Json& wanted) {
    const Json id = wanted.value("id", Json());
    const Json channel = wanted.value("channelId", Json());
    if (!id.is_number_unsigned() || !channel.is_number_unsigned()) return;
    if (viewer->subscriptions.size() >= kMostSubscriptions) return;
    const std::lock_guard lock(mutex);
    const auto c = channel.get<std::uint64_t>();
    if (c >= channels.size() || id.get<std::uint64_t>() > UINT32_MAX) return;
    const auto subscription = id.get<std::uint32_t>();
    viewer->subscriptions[subscription] = static_cast<std::uint16_t>(c);
    if (channels[c].latest.payload) push_data(viewer, subscription, channels[c].latest);
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
    Viewer& viewer = viewers[wsi];
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
    Viewer& viewer = viewers[wsi];
    if (viewer.waiting.empty()) return 0;
    Outgoing next = std::move(viewer.waiting.front());
    viewer.waiting.pop_front();
    viewer.waiting_bytes -= next.bytes.size();
    --unsent;
    auto* const data = reinterpret_cast<unsigned char*>(next.bytes.data()) + LWS_PRE;
    const std::size_t count = next.bytes.size() - LWS_PRE;
    if (lws_write(wsi, data, count, next.text ? LWS_WRITE_TEXT : LWS_WRITE_BINARY) < 0) return -1;
    if (!viewer.waiting.empty()) lws_callback_on_writable(wsi);
    return 0;
  }

  void leave(lws* wsi) {
    const auto at = viewers.find(wsi);
    if (at == viewers.end()) return;
    unsent -= at->second.waiting.size();
    viewers.erase(at);
  }

  static int callback(lws* wsi, lws_callback_reasons reason, void* /*user*/, void* in,
                      std::size_t count) {
    auto* const self = static_cast<Impl*>(lws_context_user(lws_get_context(wsi)));
    switch (reason) {
      case LWS_CALLBACK_ESTABLISHED:
        if (self->viewers.size() >= kMostViewers) return -1;
        self->greet(wsi);
        lws_callback_on_writable(wsi);
        return 0;
      case LWS_CALLBACK_RECEIVE:
        return self->receive(wsi, in, count);
      case LWS_CALLBACK_SERVER_WRITEABLE:
        return self->write(wsi);
      case LWS_CALLBACK_CLOSED:
        self->leave(wsi);
        return 0;
      case LWS_CALLBACK_EVENT_WAIT_CANCELLED:
        self->distribute();
        return 0;
      case LWS_CALLBACK_HTTP:
        return -1;  // no pages here
      default:
        return 0;
    }
  }
};

LiveServer::LiveServer(const std::string& address, int port) : impl_(std::make_unique<Impl>()) {
  static const lws_protocols kProtocols[] = {{kProtocol, &Impl::callback, 0, 4096, 0, nullptr, 0},
                                             {nullptr, nullptr, 0, 0, 0, nullptr, 0}};
  lws_set_log_level(0, nullptr);
  lws_context_creation_info info{};
  info.port = port;
  info.iface = address.c_str();
  info.protocols = kProtocols;
  info.user = impl_.get();
  info.gid = static_cast<decltype(info.gid)>(-1);
  info.uid = static_cast<decltype(info.uid)>(-1);
  info.options = LWS_SERVER_OPTION_FAIL_UPON_UNABLE_TO_BIND;
  impl_->context = lws_create_context(&info);
  if (impl_->context == nullptr) {
    throw std::runtime_error("--view: cannot listen on " + address + ":" + std::to_string(port));
  }
  lws_vhost* const host = lws_get_vhost_by_name(impl_->context, "default");
  impl_->port = host != nullptr ? lws_get_vhost_listen_port(host) : port;
  impl_->thread = std::thread([impl = impl_.get()] {
    while (!impl->stop) lws_service(impl->context, 0);
  });
}

LiveServer::~LiveServer() {
  impl_->stop = true;
  lws_cancel_service(impl_->context);
  impl_->thread.join();
  lws_context_destroy(impl_->context);
}

int LiveServer::port() const {
  return impl_->port;
}

std::uint64_t LiveServer::dropped() const {
  return impl_->dropped;
}

std::uint16_t LiveServer::add_channel(const std::string& topic, const std::string& type,
                                      const std::string& definition, bool latest_stays) {
  const std::lock_guard lock(impl_->mutex);
  const auto id = static_cast<std::uint16_t>(impl_->channels.size());
  impl_->channels.push_back({{{"id", id},
                              {"topic", topic},
                              {"encoding", "cdr"},
                              {"schemaName", type},
                              {"schema", definition},
                              {"schemaEncoding", "ros2msg"}},
                             latest_stays,
                             {}});
  return id;
}

void LiveServer::add(std::uint16_t channel, Time time, std::string_view message) {
  Message queued{channel, static_cast<std::uint64_t>(time.count()),
                 std::make_shared<const std::string>(message)};
  {
    const std::lock_guard lock(impl_->mutex);
    if (impl_->channels[channel].latest_stays) impl_->channels[channel].latest = queued;
    if (impl_->queue_bytes + message.size() > kMostWaiting) {
      ++impl_->dropped;
      return;
    }
    impl_->queue_bytes += message.size();
    impl_->queue.push_back(std::move(queued));
  }
}

void LiveServer::flush(Time /*time*/) {
  lws_cancel_service(impl_->context);
}

void LiveServer::close() {
  flush(Time{0});
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(1);
  while (impl_->unsent > 0 && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

}  // namespace rio::view
