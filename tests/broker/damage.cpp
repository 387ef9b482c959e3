// SPDX-License-Identifier: Apache-2.0
#include "damage.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <cstring>
#include <optional>

#include <rths/broker/ring.hpp>
#include <rths/core/error.hpp>

#include "broker/src/record.hpp"
#include "broker/src/segment.hpp"
#include "support/ring_maps.hpp"

namespace rths::broker {
namespace {

using Random = std::mt19937_64;

constexpr std::uint32_t kBits = 6;
constexpr std::uint32_t kGroups[] = {5, 12, 40};  // a latch, a line, a bulk record
constexpr Claim kDead = 1ULL << 40 | 999'999'999;

std::uint64_t below(Random& random, std::uint64_t end) { return end == 0 ? 0 : random() % end; }

// A value near a correct one, near a limit of a type, or any.
std::uint64_t hostile(Random& random, std::uint64_t correct) {
  const std::array<std::uint64_t, 16> values{0,
                                             1,
                                             correct + 1,
                                             correct - 1,
                                             correct + 4096,
                                             correct * 2,
                                             ~std::uint64_t{0},
                                             std::uint64_t{1} << 63U,
                                             std::uint64_t{1} << 40U,
                                             std::uint64_t{1} << 32U,
                                             std::uint64_t{1} << 31U,
                                             (std::uint64_t{1} << 31U) - 1,
                                             std::uint64_t{1} << 28U,
                                             below(random, 4096),
                                             below(random, 64),
                                             random()};
  return values[below(random, values.size())];
}

template <class T>
void damage_word(RingImage& image, std::uint64_t at, Random& random) {
  if (at + sizeof(T) > image.bytes.size()) return;
  T word{};
  std::memcpy(&word, image.bytes.data() + at, sizeof word);
  word = static_cast<T>(hostile(random, word));
  std::memcpy(image.bytes.data() + at, &word, sizeof word);
}

Header header_of(const RingImage& image) {
  Header header{};
  std::memcpy(&header, image.bytes.data(), sizeof header);
  return header;
}

void damage_bytes(RingImage& image, Random& random) {
  for (std::uint64_t i = below(random, 64) + 1; i > 0; --i)
    image.bytes[below(random, image.bytes.size())] = static_cast<char>(random());
}

void damage_header(RingImage& image, Random& random) {
  damage_word<std::uint64_t>(image, 8 * below(random, 20), random);
}

void damage_slot(RingImage& image, Random& random) {
  const std::uint64_t slot = sizeof(Header) + below(random, kMaxSlots) * sizeof(Slot);
  const std::array<Claim, 4> claims{own_claim(), kDead, random(), 1};
  const Claim claim = claims[below(random, claims.size())];
  std::memcpy(image.bytes.data() + slot, &claim, sizeof claim);
  damage_word<std::uint32_t>(image, slot + 8 + 4 * below(random, 4), random);
}

void damage_group(RingImage& image, Random& random) {
  const std::uint64_t table = header_of(image).groups_at;
  const std::uint64_t group = table + below(random, std::size(kGroups)) * sizeof(Group);
  const std::uint64_t other = table + below(random, std::size(kGroups)) * sizeof(Group);
  if (group != other && below(random, 4) == 0)
    std::memcpy(image.bytes.data() + group, image.bytes.data() + other, sizeof(Group));
  else
    damage_word<std::uint32_t>(image, group + 4 * below(random, 5), random);
}

void damage_record(RingImage& image, Random& random) {
  const Header header = header_of(image);
  const std::uint64_t lines = header.records_bytes / kLineBytes;
  damage_word<std::uint32_t>(image, header.records_at + kLineBytes * below(random, lines), random);
}

void damage_map(RingImage& image, Random& random) {
  const Header header = header_of(image);
  char* text = image.bytes.data() + header.map_text_at;
  const std::uint64_t at = below(random, header.map_text_bytes);
  switch (below(random, 4)) {
    case 0:
      text[at] = static_cast<char>(random());
      break;
    case 1:
      std::memset(text + at, "9.[\""[below(random, 4)], header.map_text_bytes - at);
      break;
    case 2:
      std::memmove(text + at, text, header.map_text_bytes - at);
      break;
    default:
      for (std::uint64_t i = at; i < header.map_text_bytes; ++i)
        if (text[i] >= '0' && text[i] <= '9') {
          text[i] = static_cast<char>('0' + below(random, 10));
          break;
        }
  }
}

// Entries with the lap of their position, so that readers take them for valid ones.
void damage_journal(RingImage& image, Random& random) {
  const Header header = header_of(image);
  const std::uint64_t journal =
      journal_at(header, static_cast<std::uint32_t>(below(random, header.journal_count)));
  if (below(random, 3) == 0) damage_word<std::uint64_t>(image, journal, random);
  std::uint64_t hint = 0;
  std::memcpy(&hint, image.bytes.data() + journal, sizeof hint);
  const JournalView view{nullptr, nullptr, kBits};
  for (std::uint64_t i = below(random, 80); i > 0; --i) {
    const std::uint64_t position = hint + below(random, 64);
    const auto word = [&] { return static_cast<std::uint32_t>(hostile(random, 40)); };
    const auto kind = static_cast<std::uint32_t>(below(random, 6));
    const JournalEntry entry{word(), word(), word(), view.lap(position) << 4U | kind};
    std::memcpy(image.bytes.data() + journal + sizeof(JournalHead) + (position % 64) * sizeof entry,
                &entry, sizeof entry);
  }
}

void damage_size(RingImage& image, Random& random) {
  const std::array<std::uint64_t, 5> sizes{hostile(random, image.size) % (std::uint64_t{1} << 41U),
                                           below(random, image.size), below(random, 32768),
                                           4096 * below(random, 16), header_of(image).memory_at};
  image.size = sizes[below(random, sizes.size())];
}

}  // namespace

memmap::Map map_to_damage() {
  memmap::MapDescription description;
  description.name = "damaged";
  description.size_longwords = 1024;
  description.nodes = {{"machine", NodeId{1}, ""}, {"controller", NodeId{2}, ""}};
  std::uint32_t base = 0;
  for (const std::uint32_t longwords : {kGroups[0], kGroups[1], kGroups[2], 3U}) {
    memmap::Partition partition;
    partition.name = "p" + std::to_string(longwords);
    partition.node = longwords == kGroups[1] ? "controller" : "machine";
    partition.base = LongwordOffset{base};
    partition.longwords = longwords;
    partition.tear_group = longwords != 3;
    memmap::Signal signal;
    signal.name = "long";
    signal.unit = "mm";
    signal.offset = LongwordOffset{base + 1};
    partition.signals = {signal};
    description.partitions.push_back(partition);
    base += longwords;
  }
  return memmap::Map{description};
}

RingImage ring_to_damage() {
  const std::string name = test::unique_ring("to_damage");
  const test::RingRemoval removal{name};
  Ring ring = Ring::create(name, map_to_damage(), kBits);
  for (const char* node : {"machine", "controller"}) {
    Node writer = ring.join(node, 0);
    for (std::uint32_t i = 0; i < 30; ++i) {
      writer.beat();
      for (std::uint32_t group = 0; group < std::size(kGroups); ++group)
        static_cast<void>(
            writer.write_group(TearGroupId{group}, std::vector<std::uint32_t>(kGroups[group], i)));
      static_cast<void>(writer.write(LongwordOffset{58}, i));
    }
  }
  const auto segment = Segment::attach_shared(name);
  const Header& layout = segment->layout();
  segment->slots()[0].claim = 0;
  segment->slots()[1] = {kDead, 1, 0, 5, 0};
  RingImage image{std::string(layout.cards_at, '\0'), total_bytes(layout)};
  const auto object = SharedObject::open(name);
  if (!object.read(0, image.bytes.data(), image.bytes.size())) std::abort();
  const Claim creator = kDead;
  std::memcpy(image.bytes.data() + offsetof(Header, creator), &creator, sizeof creator);
  return image;
}

RingImage damaged(RingImage image, std::uint64_t seed) {
  Random random{seed};
  constexpr std::array kDamages{damage_bytes,  damage_header, damage_slot,    damage_group,
                                damage_record, damage_map,    damage_journal, damage_size};
  for (std::uint64_t i = below(random, 3) + 1; i > 0; --i) {
    const RingImage before = image;
    // Later damage finds its place by the header.
    if (header_of(image).records_at > image.bytes.size()) return image;
    kDamages[below(random, kDamages.size())](image, random);
    if (!is_same_layout(header_of(image), header_of(before))) return image;
  }
  return image;
}

void install(const RingImage& image, const std::string& ring) {
  remove_object(ring);
  const int file =
      shm_open(("/" + object_name(ring)).c_str(), O_CREAT | O_EXCL | O_RDWR | O_CLOEXEC, 0600);
  if (file < 0 || write(file, image.bytes.data(), image.bytes.size()) < 0 ||
      ftruncate(file, static_cast<off_t>(image.size)) != 0)
    std::abort();
  close(file);
}

}  // namespace rths::broker
