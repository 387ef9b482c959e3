// SPDX-License-Identifier: Apache-2.0
//
// The carrier over Cyclone DDS: one reliable topic; a ring's name is its DDS partition.
#include <array>
#include <mutex>

#include <dds/dds.h>
#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/dds/carrier.hpp>

#include "frame.h"

namespace rths::dds {
namespace {

constexpr dds_duration_t kLongestBlock = DDS_SECS(1);

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
  return fmt::format(
      "<CycloneDDS><Domain id=\"any\"><General>{}{}</General>{}</Domain></CycloneDDS>", interfaces,
      peers.empty() ? "" : "<AllowMulticast>false</AllowMulticast>",
      peers.empty() ? ""
                    : fmt::format("<Discovery><ParticipantIndex>auto</ParticipantIndex>"
                                  "<MaxAutoParticipantIndex>32</MaxAutoParticipantIndex>"
                                  "<Peers>{}</Peers></Discovery>",
                                  peers));
}

dds_entity_t checked(dds_entity_t entity, const char* what) {
  if (entity < 0)
    throw Error{fmt::format("DDS: the {} cannot be created: {}", what, dds_strretcode(-entity))};
  return entity;
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
    if (domain < 0 && domain != DDS_RETCODE_PRECONDITION_NOT_MET) checked(domain, "domain");
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

  bool receive(std::vector<std::byte>& bytes, Duration timeout) override {
    if (take(bytes)) return true;
    dds_waitset_wait(arrival_, nullptr, 0, timeout.count());
    return take(bytes);
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
    arrival_ = checked(dds_create_waitset(participant_), "waitset");
    dds_set_status_mask(reader_, DDS_DATA_AVAILABLE_STATUS);
    dds_waitset_attach(arrival_, reader_, 0);
  }

  bool take(std::vector<std::byte>& bytes) {
    std::array<void*, 1> samples{};
    dds_sample_info_t info{};
    for (;;) {
      const dds_return_t count = dds_take(reader_, samples.data(), &info, 1, 1);
      if (count <= 0) return false;
      const bool valid = info.valid_data;
      if (valid) {
        const auto& content = static_cast<const rths_dds_Bytes*>(samples[0])->content;
        const auto* begin = reinterpret_cast<const std::byte*>(content._buffer);
        bytes.assign(begin, begin + content._length);
      }
      dds_return_loan(reader_, samples.data(), count);
      if (valid) return true;
    }
  }

  dds_entity_t participant_ = 0, writer_ = 0, reader_ = 0, arrival_ = 0;
};

}  // namespace

std::unique_ptr<Carrier> make_cyclone_carrier(const CycloneOptions& options) {
  return std::make_unique<CycloneCarrier>(options);
}

}  // namespace rths::dds
