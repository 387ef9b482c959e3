// SPDX-License-Identifier: Apache-2.0
//
// Vendor's calls: save and load memory or ACR as a text file. A line of memory is
// "offset:value:format:bytes", with the value in that printf format; a line of the ACR is
// "offset:value". Offsets are hexadecimal, in bytes.
#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>

#include <rths/core/text.hpp>

#include "plus_state.hpp"
#include "ring_copy.hpp"

#include <scrplus.h>

using namespace rths::scramnet;

namespace {

enum FileError {
  kNoMemory = -1,
  kNoRegisters = -2,
  kNotOpen = -3,
  kNotRead = -4,
  kPastEnd = -5,
  kBadCommand = -6
};

struct Closer {
  void operator()(FILE* file) const {
    std::fclose(file);  // NOLINT(cppcoreguidelines-owning-memory): the pointer owns it
  }
};
using File = std::unique_ptr<FILE, Closer>;

int defect_of(int which) {
  if (card_with_memory() == nullptr) return kNoMemory;
  if (card_with_registers() == nullptr) return kNoRegisters;
  return which == MEM || which == ACR ? 0 : kBadCommand;
}

// Parses a value by the last letter of its format. The format comes from a file, so it is never
// passed to scanf.
bool parse_value(const char* text, char conversion, unsigned bytes, unsigned char* value) {
  char* end = nullptr;
  if (std::strchr("eEfFgG", conversion) != nullptr) {
    const auto number = rths::number_of(rths::trimmed(text));
    if (!number || (bytes != 4 && bytes != 8)) return false;
    const auto single = static_cast<float>(*number);
    std::memcpy(value, bytes == 8 ? static_cast<const void*>(&*number) : &single, bytes);
    return true;
  }
  const int base = conversion == 'o' ? 8 : std::strchr("xX", conversion) != nullptr ? 16 : 10;
  const bool is_signed = conversion == 'd' || conversion == 'i';
  const auto number = is_signed ? static_cast<std::uint64_t>(std::strtoll(text, &end, base))
                                : std::strtoull(text, &end, base);
  std::memcpy(value, &number, bytes);
  return end != text;
}

int load_memory_line(Board& card, const char* line) {
  unsigned long offset = 0;
  unsigned bytes = 0;
  char text[64];
  char format[16];
  if (std::sscanf(line, "%lx:%63[^:]:%15[^:]:%u", &offset, text, format, &bytes) != 4)
    return kNotRead;
  if (bytes == 0 || bytes > 8 || (bytes & (bytes - 1)) != 0) return kNotRead;
  unsigned char value[8] = {};
  if (!parse_value(text, format[std::strlen(format) - 1], bytes, value)) return kNotRead;
  if (offset > card.window_bytes() || bytes > card.window_bytes() - offset) return kPastEnd;
  card.store(offset, reinterpret_cast<const std::byte*>(value), bytes);
  return 0;
}

int load_acr_line(Board& card, const char* line) {
  unsigned long offset = 0;
  unsigned value = 0;
  if (std::sscanf(line, "%lx:%x", &offset, &value) != 2) return kNotRead;
  if (offset >= card.window_bytes()) return kPastEnd;
  card.write_acr(static_cast<std::uint32_t>(offset / 4), value);
  return 0;
}

}  // namespace

extern "C" {

int scr_load_mm(char* name, int which) {
  if (const int error = defect_of(which); error != 0) return error;
  const File file{std::fopen(name, "r")};
  if (!file) return kNotOpen;
  char line[160];
  int result = 0;
  while (result == 0 && std::fgets(line, sizeof line, file.get()) != nullptr)
    if (line[0] != '\n')
      result = which == MEM ? load_memory_line(*board(), line) : load_acr_line(*board(), line);
  return result == 0 && std::ferror(file.get()) != 0 ? kNotRead : result;
}

int scr_save_mm(char* name, int which) {
  if (const int error = defect_of(which); error != 0) return error;
  const File file{std::fopen(name, "w")};
  if (!file) return kNotOpen;
  const Board& card = *board();
  const auto* words = reinterpret_cast<const Word*>(card.memory());
  for (std::uint64_t i = 0; i < card.window_bytes() / 4; ++i)
    if (which == MEM)
      std::fprintf(file.get(), "%" PRIx64 ":%x:%%x:4\n", i * 4, words[i].load());
    else
      std::fprintf(file.get(), "%" PRIx64 ":%x\n", i * 4, card.acr()[i].load() & ACR_MASK);
  return std::ferror(file.get()) != 0 ? kNotRead : 0;
}
}
