// SPDX-License-Identifier: Apache-2.0
#include "exports.hpp"

#include <elf.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <iterator>

#include <rths/core/error.hpp>
#include <rths/plugin/conformance.hpp>

namespace rths::plugin {
namespace {

/// The bytes of a file. Reads beyond its end are Errors.
class Bytes {
 public:
  explicit Bytes(const std::filesystem::path& file) : name_{file.string()} {
    std::ifstream stream{file, std::ios::binary};
    bytes_.assign(std::istreambuf_iterator<char>{stream}, {});
  }
  template <class Value>
  [[nodiscard]] Value at(std::size_t offset) const {
    if (offset > bytes_.size() || bytes_.size() - offset < sizeof(Value))
      throw Error{name_ + ": is not a complete shared library"};
    Value value;
    std::memcpy(&value, bytes_.data() + offset, sizeof value);
    return value;
  }
  [[nodiscard]] std::string text_at(std::size_t offset) const {
    std::string text;
    for (char c = at<char>(offset); c != '\0'; c = at<char>(++offset)) text += c;
    return text;
  }

 private:
  std::string name_;
  std::string bytes_;
};

bool is_export(const Elf64_Sym& symbol) {
  const auto binding = ELF64_ST_BIND(symbol.st_info);
  const auto type = ELF64_ST_TYPE(symbol.st_info);
  const auto visibility = ELF64_ST_VISIBILITY(symbol.st_other);
  return symbol.st_shndx != SHN_UNDEF && symbol.st_shndx < SHN_LORESERVE && binding != STB_LOCAL &&
         visibility == STV_DEFAULT &&
         (type == STT_FUNC || type == STT_OBJECT || type == STT_GNU_IFUNC || type == STT_TLS);
}

}  // namespace

bool is_library(const std::filesystem::path& file) {
  std::ifstream stream{file, std::ios::binary};
  char magic[SELFMAG]{};
  return stream.read(magic, SELFMAG) && std::memcmp(magic, ELFMAG, SELFMAG) == 0;
}

std::vector<std::string> exported_symbols(const std::filesystem::path& library) {
  const Bytes bytes{library};
  const auto header = bytes.at<Elf64_Ehdr>(0);
  if (header.e_ident[EI_CLASS] != ELFCLASS64)
    throw Error{library.string() + ": is not a library of 64 bits"};
  const auto section = [&](std::size_t index) {
    return bytes.at<Elf64_Shdr>(header.e_shoff + index * sizeof(Elf64_Shdr));
  };
  std::vector<std::string> names;
  for (std::size_t i = 0; i < header.e_shnum; ++i) {
    const auto table = section(i);
    if (table.sh_type != SHT_DYNSYM) continue;
    const auto strings = section(table.sh_link);
    for (std::size_t at = 0; at < table.sh_size; at += sizeof(Elf64_Sym)) {
      const auto symbol = bytes.at<Elf64_Sym>(table.sh_offset + at);
      if (is_export(symbol)) names.push_back(bytes.text_at(strings.sh_offset + symbol.st_name));
    }
  }
  std::erase_if(names, [](const auto& name) { return name == "_init" || name == "_fini"; });
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace rths::plugin
