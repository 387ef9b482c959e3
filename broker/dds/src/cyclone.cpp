// SPDX-License-Identifier: Apache-2.0
//
// The carrier over Cyclone DDS: one reliable topic; a ring's name is its DDS partition.
#include <arpa/inet.h>
#include <fcntl.h>
#include <sys/socket.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <future>
#include <mutex>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

#include <dds/dds.h>
#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/core/message.hpp>
#include <rths/dds/carrier.hpp>
#include <rths/dds/network.hpp>

#include "frame.h"
#include "hello.hpp"

namespace rths::dds {
namespace {

// The local address of an IPv4 UDP socket; empty for anything else.
std::optional<in_addr> address_of(int socket) {
  int type = 0;
  socklen_t size = sizeof type;
  if (getsockopt(socket, SOL_SOCKET, SO_TYPE, &type, &size) != 0 || type != SOCK_DGRAM)
    return std::nullopt;
  sockaddr_in address{};
  size = sizeof address;
  if (getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size) != 0 ||
      address.sin_family != AF_INET)
    return std::nullopt;
  return address.sin_addr;
}

std::string text_of(in_addr address) {
  std::array<char, INET_ADDRSTRLEN> text{};
  inet_ntop(AF_INET, &address, text.data(), text.size());
  return text.data();
}

// The interface that has an address; a further address of an interface may have a label, "eth0:1".
std::string interface_with(const std::string& address) {
  for (const auto& interface : interfaces())
    if (interface.address == address) return interface.name.substr(0, interface.name.find(':'));
  return "";
}

/// IPv4 UDP sockets of this process.
std::set<int> udp_sockets() {
  std::set<int> sockets;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator{"/proc/self/fd", error}) {
    const std::string name = entry.path().filename();
    int descriptor = -1;
    std::from_chars(name.data(), name.data() + name.size(), descriptor);
    if (address_of(descriptor)) sockets.insert(descriptor);
  }
  return sockets;
}

/// Binds the UDP sockets that this process has made since to the network interface that one of them
/// has the address of: datagrams of other interfaces do not reach them. Programs that this one
/// starts do not inherit them. Sockets of several interfaces stay as they are.
/// @param before  the sockets at the beginning
/// @returns why not, such as a missing privilege; empty if they are bound or need not be
std::string bind_new_sockets(const std::set<int>& before) {
  std::set<int> made;
  std::set<std::string> addresses;
  for (const int socket : udp_sockets())
    if (const auto address = address_of(socket); address && !before.contains(socket)) {
      made.insert(socket);
      fcntl(socket, F_SETFD, FD_CLOEXEC);  // NOLINT(cppcoreguidelines-pro-type-vararg)
      if (address->s_addr != INADDR_ANY) addresses.insert(text_of(*address));
    }
  if (addresses.size() != 1) return "";
  const std::string interface = interface_with(*addresses.begin());
  for (const int socket : made)
    if (setsockopt(socket, SOL_SOCKET, SO_BINDTODEVICE, interface.data(),
                   static_cast<socklen_t>(interface.size())) != 0)
      return fmt::format("sockets cannot be bound to interface '{}': {}", interface,
                         std::strerror(errno));
  return "";
}

constexpr dds_duration_t kLongestBlock = DDS_SECS(1);
constexpr dds_duration_t kLongestFarewell = DDS_MSECS(200);
constexpr std::chrono::seconds kLongestLeave{3};
// A host that died blocks the others for this long; one that was only stopped is found again.
constexpr const char* kLease = "2 s";
constexpr std::size_t kSamples = 16;        // taken at once
constexpr std::size_t kParticipants = 256;  // of a domain, at most
// Iceoryx, which the settings of other software may ask for, ends a process that has no RouDi after
// a minute.
#ifdef DDS_HAS_SHM
constexpr const char* kNoSharedMemory = "<SharedMemory><Enable>false</Enable></SharedMemory>";
#else
constexpr const char* kNoSharedMemory = "";
#endif

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '"' || c == '<' || c == '&')
      throw Error{fmt::format("'{}' is no interface or address", text)};
    result += c;
  }
  return result;
}

std::string configuration_of(const CycloneOptions& options) {
  std::string interfaces, peers;
  if (!options.interface.empty()) {
    const char* kind =
        options.interface.find_first_of(".:") == std::string::npos ? "name" : "address";
    interfaces = fmt::format("<Interfaces><NetworkInterface {}=\"{}\"/></Interfaces>", kind,
                             escaped(options.interface));
  }
  for (const auto& peer : options.peers)
    peers += fmt::format("<Peer address=\"{}\"/>", escaped(peer));
  const std::string discovery = peers.empty()
                                    ? ""
                                    : fmt::format(
                                          "<ParticipantIndex>auto</ParticipantIndex>"
                                          "<MaxAutoParticipantIndex>32</MaxAutoParticipantIndex>"
                                          "<Peers>{}</Peers>",
                                          peers);
  const auto domain = [](const std::string& settings) {
    return "<CycloneDDS><Domain id=\"any\">" + settings + "</Domain></CycloneDDS>";
  };
  // Of several values of a setting, the last one counts: our default, the user's file, the options.
  const char* const file = std::getenv("CYCLONEDDS_URI");
  return fmt::format(
      "{},{},{}",
      domain(fmt::format("<Discovery><LeaseDuration>{}</LeaseDuration></Discovery>", kLease)),
      file == nullptr ? "" : file,
      domain(fmt::format("<General>{}{}</General><Discovery>{}</Discovery>{}", interfaces,
                         peers.empty() ? "" : "<AllowMulticast>false</AllowMulticast>", discovery,
                         kNoSharedMemory)));
}

// User data of the participant of a gateway: this word, its id, the names of host and ring.
constexpr std::string_view kGateway = "rths gateway";
constexpr std::size_t kIdDigits = 16;

std::string announcement_of(std::uint64_t id, const CycloneOptions& options) {
  return options.host.empty()
             ? ""
             : fmt::format("{}{:016x}{}\n{}", kGateway, id, options.host, options.ring);
}

std::optional<PresentHost> host_from(std::string_view announcement) {
  if (!announcement.starts_with(kGateway)) return std::nullopt;
  announcement.remove_prefix(kGateway.size());
  const auto end_of_host = announcement.find('\n');
  if (end_of_host == std::string_view::npos || end_of_host < kIdDigits) return std::nullopt;
  PresentHost host;
  std::from_chars(announcement.data(), announcement.data() + kIdDigits, host.id, 16);
  host.host = announcement.substr(kIdDigits, end_of_host - kIdDigits);
  host.ring = announcement.substr(end_of_host + 1);
  return host;
}

std::optional<PresentHost> host_of(const dds_builtintopic_participant_t& participant) {
  void* data = nullptr;
  std::size_t size = 0;
  if (!dds_qget_userdata(participant.qos, &data, &size) || data == nullptr) return std::nullopt;
  const auto host = host_from({static_cast<const char*>(data), size});
  dds_free(data);
  return host;
}

dds_entity_t checked(dds_entity_t entity, const char* what) {
  if (entity < 0)
    throw Error{fmt::format("DDS: the {} cannot be created: {}", what, dds_strretcode(-entity))};
  return entity;
}

[[noreturn]] void fail_to_start(dds_return_t reason) {
  if (const char* const file = std::getenv("CYCLONEDDS_URI"))
    throw Error{
        fmt::format("DDS refuses its settings, see above: those of this command and of "
                    "CYCLONEDDS_URI, which is "
                    "'{}', expected file://PATH of an XML file with settings of Cyclone DDS; name "
                    "an interface in "
                    "one of them only",
                    file)};
  throw Error{fmt::format("DDS: the domain cannot be created: {}", dds_strretcode(-reason))};
}

std::atomic<std::uint64_t> warnings_of_dds{0};  // in this process

// Damaged datagrams make hundreds of warnings. `Tracing` in the settings writes them all to a file.
void print_errors_and_first_warning(void*, const dds_log_data_t* line) {
  const bool is_warning = (line->priority & DDS_LC_WARNING) != 0;
  if (is_warning && warnings_of_dds++ != 0) return;
  write_message(fmt::format("rths: DDS: {}{}\n", printable({line->message, line->size}),
                            is_warning ? "; further warnings are not printed" : ""));
}

struct Qos {
  dds_qos_t* qos = dds_create_qos();
  ~Qos() { dds_delete_qos(qos); }
};

class CycloneCarrier final : public Carrier {
 public:
  explicit CycloneCarrier(CycloneOptions options) : options_{std::move(options)} {
    dds_set_log_sink(print_errors_and_first_warning, nullptr);
    join();
  }
  ~CycloneCarrier() override {
    dds_wait_for_acks(writer_, kLongestFarewell);
    leave();
  }

  bool send(std::span<const std::byte> bytes) override {
    if (is_leaving_) return false;
    const std::lock_guard lock{sending_};
    rths_dds_Bytes sample{};
    sample.content._buffer =
        const_cast<std::uint8_t*>(reinterpret_cast<const std::uint8_t*>(bytes.data()));
    sample.content._length = sample.content._maximum = static_cast<std::uint32_t>(bytes.size());
    return writer_ != 0 && dds_write(writer_, &sample) == DDS_RETCODE_OK;
  }

  void listen(Handler handle) override {
    const std::lock_guard lock{mutex_};
    handle_ = std::move(handle);
    if (handle_) hand_over();
  }

  std::vector<PresentHost> present() override {
    std::array<void*, kParticipants> samples{};
    std::array<dds_sample_info_t, kParticipants> infos{};
    const auto look = [&](auto function, std::uint32_t instances, auto visit) {
      const dds_return_t count =
          function(participants_, samples.data(), infos.data(), kParticipants, kParticipants,
                   DDS_ANY_SAMPLE_STATE | DDS_ANY_VIEW_STATE | instances);
      for (dds_return_t i = 0; i < count; ++i) visit(static_cast<std::size_t>(i));
      if (count > 0) dds_return_loan(participants_, samples.data(), count);
      samples.fill(nullptr);
    };
    constexpr std::uint32_t kGone =
        DDS_NOT_ALIVE_DISPOSED_INSTANCE_STATE | DDS_NOT_ALIVE_NO_WRITERS_INSTANCE_STATE;
    look(dds_take_mask, kGone, [](std::size_t) {});
    std::vector<PresentHost> hosts;
    look(dds_read_mask, DDS_ALIVE_INSTANCE_STATE, [&](std::size_t i) {
      if (!infos[i].valid_data) return;
      auto host = host_of(*static_cast<const dds_builtintopic_participant_t*>(samples[i]));
      if (host && host->id != id() && (options_.ring == "*" || options_.ring == host->ring))
        hosts.push_back(std::move(*host));
    });
    return hosts;
  }

  // DDS warns of little else once it runs.
  std::uint64_t damaged() const override { return warnings_of_dds; }

  void rejoin() override {
    is_leaving_ = true;
    dds_delete(writer_);  // wakes a sender that waits for others
    const std::lock_guard lock{sending_};
    if (!leave()) return;  // tried again
    is_leaving_ = false;
    join();
  }

 private:
  // A domain has one configuration per process; a second carrier uses it too.
  void join() {
    const auto sockets = udp_sockets();
    domain_ = dds_create_domain(options_.domain, configuration_of(options_).c_str());
    if (domain_ < 0 && domain_ != DDS_RETCODE_PRECONDITION_NOT_MET) fail_to_start(domain_);
    try {
      create_participant();
      const std::string unbound = bind_new_sockets(sockets);
      if (!unbound.empty()) write_message(fmt::format("rths: {}\n", unbound));
      create_topic();
    } catch (...) {
      leave();
      throw;
    }
  }

  // Deletes all that Cyclone knows of other hosts: it belongs to the domain. Threads that receive
  // end with a datagram to themselves, and while their interface is gone, not at all: they stay.
  // @returns whether all is deleted
  bool leave() {
    if (!left_.valid()) {
      dds_set_listener(reader_, nullptr);
      std::packaged_task<void()> deletion{
          [all = domain_ > 0 ? domain_ : participant_] { dds_delete(all); }};
      left_ = deletion.get_future();
      std::thread{std::move(deletion)}.detach();
      const std::lock_guard lock{mutex_};
      domain_ = participant_ = participants_ = writer_ = reader_ = 0;
    }
    if (left_.wait_for(kLongestLeave) != std::future_status::ready) {
      write_message("rths: DDS cannot leave the network: its interface is gone\n");
      return false;
    }
    left_ = {};
    return true;
  }

  void create_participant() {
    const Qos announced;
    const std::string announcement = announcement_of(id(), options_);
    dds_qset_userdata(announced.qos, announcement.data(), announcement.size());
    participant_ =
        checked(dds_create_participant(options_.domain, announced.qos, nullptr), "participant");
    participants_ = checked(
        dds_create_reader(participant_, DDS_BUILTIN_TOPIC_DCPSPARTICIPANT, nullptr, nullptr),
        "reader of participants");
  }

  void create_topic() {
    const Qos of_ring, reliable;
    const char* partition = options_.ring.c_str();
    dds_qset_partition(of_ring.qos, 1, &partition);
    dds_qset_reliability(reliable.qos, DDS_RELIABILITY_RELIABLE, kLongestBlock);
    dds_qset_history(reliable.qos, DDS_HISTORY_KEEP_ALL, 0);
    dds_qset_ignorelocal(reliable.qos, DDS_IGNORELOCAL_PARTICIPANT);
    const dds_entity_t topic =
        checked(dds_create_topic(participant_, &rths_dds_Bytes_desc, "rths_ring", nullptr, nullptr),
                "topic");
    const dds_entity_t publisher =
        checked(dds_create_publisher(participant_, of_ring.qos, nullptr), "publisher");
    const dds_entity_t subscriber =
        checked(dds_create_subscriber(participant_, of_ring.qos, nullptr), "subscriber");
    writer_ = checked(dds_create_writer(publisher, topic, reliable.qos, nullptr), "writer");
    const dds_entity_t reader =
        checked(dds_create_reader(subscriber, topic, reliable.qos, nullptr), "reader");
    {
      const std::lock_guard lock{mutex_};
      reader_ = reader;
    }
    dds_listener_t* const listener = dds_create_listener(this);
    dds_lset_data_available(listener, [](dds_entity_t, void* carrier) {
      auto& self = *static_cast<CycloneCarrier*>(carrier);
      const std::lock_guard lock{self.mutex_};
      if (self.handle_) self.hand_over();
    });
    dds_set_listener(reader, listener);
    dds_delete_listener(listener);
  }

  // Hands over the samples that are here, as long as others come.
  void hand_over() {
    std::array<void*, kSamples> samples{};
    std::array<dds_sample_info_t, kSamples> infos{};
    for (;;) {
      const dds_return_t count =
          dds_take(reader_, samples.data(), infos.data(), kSamples, kSamples);
      if (count <= 0) return;
      for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
        if (!infos[i].valid_data) continue;
        const auto& content = static_cast<const rths_dds_Bytes*>(samples[i])->content;
        handle_({reinterpret_cast<const std::byte*>(content._buffer), content._length});
      }
      dds_return_loan(reader_, samples.data(), count);
    }
  }

  CycloneOptions options_;
  std::future<void> left_;               ///< valid while Cyclone deletes the domain
  std::atomic<bool> is_leaving_{false};  ///< nothing is sent, so that no sender keeps the lock
  std::mutex sending_;                   ///< of the writer
  std::mutex mutex_;                     ///< of the handler and the reader
  Handler handle_;
  dds_entity_t domain_ = 0, participant_ = 0, participants_ = 0, writer_ = 0, reader_ = 0;
};

}  // namespace

Carrier::Carrier() {
  std::random_device random;
  id_ = std::uint64_t{random()} << 32U | random() | 1U;
}

std::unique_ptr<Carrier> make_cyclone_carrier(const CycloneOptions& options) {
  return std::make_unique<CycloneCarrier>(options);
}

}  // namespace rths::dds
