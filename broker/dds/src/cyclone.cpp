// SPDX-License-Identifier: Apache-2.0
//
// The carrier over Cyclone DDS: one reliable topic; a ring's name is its DDS partition.
#include <array>
#include <cstdlib>
#include <mutex>
#include <utility>

#include <dds/dds.h>
#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/dds/carrier.hpp>

#include "frame.h"

namespace rths::dds {
namespace {

constexpr dds_duration_t kLongestBlock = DDS_SECS(1);
// A host that died blocks the others for this long; one that was only stopped is found again.
constexpr const char* kLease = "2 s";
constexpr std::size_t kSamples = 16;  // taken at once
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

struct Qos {
  dds_qos_t* qos = dds_create_qos();
  ~Qos() { dds_delete_qos(qos); }
};

class CycloneCarrier final : public Carrier {
 public:
  explicit CycloneCarrier(const CycloneOptions& options) {
    // A domain has one configuration per process; a second carrier uses it too.
    const dds_entity_t domain =
        dds_create_domain(options.domain, configuration_of(options).c_str());
    if (domain < 0 && domain != DDS_RETCODE_PRECONDITION_NOT_MET) fail_to_start(domain);
    participant_ = checked(dds_create_participant(options.domain, nullptr, nullptr), "participant");
    try {
      create_topic(options.ring);
    } catch (...) {
      dds_delete(participant_);
      throw;
    }
  }
  ~CycloneCarrier() override { dds_delete(participant_); }
  CycloneCarrier(const CycloneCarrier&) = delete;
  CycloneCarrier& operator=(const CycloneCarrier&) = delete;

  bool send(std::span<const std::byte> bytes) override {
    rths_dds_Bytes sample{};
    sample.content._buffer =
        const_cast<std::uint8_t*>(reinterpret_cast<const std::uint8_t*>(bytes.data()));
    sample.content._length = sample.content._maximum = static_cast<std::uint32_t>(bytes.size());
    return dds_write(writer_, &sample) == DDS_RETCODE_OK;
  }

  void listen(Handler handle) override {
    const std::lock_guard lock{mutex_};
    handle_ = std::move(handle);
    if (handle_) hand_over();
  }

 private:
  void create_topic(const std::string& ring) {
    const Qos of_ring, reliable;
    const char* partition = ring.c_str();
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
    reader_ = checked(dds_create_reader(subscriber, topic, reliable.qos, nullptr), "reader");
    dds_listener_t* const listener = dds_create_listener(this);
    dds_lset_data_available(listener, [](dds_entity_t, void* carrier) {
      auto& self = *static_cast<CycloneCarrier*>(carrier);
      const std::lock_guard lock{self.mutex_};
      if (self.handle_) self.hand_over();
    });
    dds_set_listener(reader_, listener);
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

  std::mutex mutex_;  ///< of the handler and the reader
  Handler handle_;
  dds_entity_t participant_ = 0, writer_ = 0, reader_ = 0;
};

}  // namespace

std::unique_ptr<Carrier> make_cyclone_carrier(const CycloneOptions& options) {
  return std::make_unique<CycloneCarrier>(options);
}

}  // namespace rths::dds
