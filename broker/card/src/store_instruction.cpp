// SPDX-License-Identifier: Apache-2.0
#include <rths/card/store_instruction.hpp>

#include <algorithm>

namespace rths::scramnet {
namespace {

constexpr std::uint32_t kRsp = 4, kRbp = 5;

/// What precedes an opcode.
struct Prefixes {
  bool operand16 = false, address32 = false, repeat = false, repeat_not = false;
  bool wide = false;                           ///< REX.W or VEX.W
  bool rex = false;                            ///< then registers 4 to 7 of a byte are SPL to DIL
  bool vex = false;                            ///< then `ymm` and `map` are valid
  bool ymm = false;                            ///< VEX.L
  std::uint32_t reg = 0, index = 0, base = 0;  ///< bit 3 of register numbers: 0 or 8
  std::uint32_t map = 0;                       ///< of opcodes: 0 one byte, 1 0F, 3 0F 3A
};

/// Bytes of one instruction.
class Code {
 public:
  explicit Code(std::span<const std::uint8_t> bytes)
      : bytes_{bytes.first(std::min(bytes.size(), kLongestInstruction))} {}

  /// @returns 0 behind the end
  std::uint8_t take() {
    if (at_ < bytes_.size()) return bytes_[at_++];
    complete_ = false;
    return 0;
  }
  [[nodiscard]] std::uint8_t peek() const { return at_ < bytes_.size() ? bytes_[at_] : 0; }
  /// A signed number of 1, 2, 4 bytes.
  std::uint64_t take_signed(std::uint32_t bytes) {
    std::uint64_t value = 0;
    for (std::uint32_t i = 0; i < bytes; ++i) value |= std::uint64_t{take()} << 8 * i;
    const std::uint64_t sign = std::uint64_t{1} << (8 * bytes - 1);
    return (value ^ sign) - sign;
  }
  [[nodiscard]] bool is_complete() const { return complete_; }
  [[nodiscard]] std::uint32_t taken() const { return static_cast<std::uint32_t>(at_); }

 private:
  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
  bool complete_ = true;
};

/// Decodes an instruction part by part.
class Decoder {
 public:
  Decoder(std::span<const std::uint8_t> code, const CpuState& cpu) : code_{code}, cpu_{&cpu} {}

  std::optional<StoreInstruction> decode() {
    if (!read_prefixes()) return std::nullopt;
    const std::uint8_t opcode = code_.take();
    const bool found = prefix_.vex        ? decode_vex(opcode)
                       : prefix_.map == 0 ? decode_one_byte(opcode)
                       : prefix_.map == 1 ? decode_two_bytes(opcode)
                                          : false;
    if (!found || !code_.is_complete()) return std::nullopt;
    store_.length = code_.taken();
    if (rip_relative_) store_.address += cpu_->next + store_.length;
    if (prefix_.address32) store_.address &= 0xFFFF'FFFF;
    return store_;
  }

 private:
  // FS, GS and EVEX are not supported: no opcode begins with them.
  bool read_prefixes() {
    for (;;) {
      switch (code_.peek()) {
        case 0x66:
          prefix_.operand16 = true;
          break;
        case 0x67:
          prefix_.address32 = true;
          break;
        case 0xF2:
          prefix_.repeat_not = true;
          prefix_.repeat = false;
          break;
        case 0xF3:
          prefix_.repeat = true;
          prefix_.repeat_not = false;
          break;
        case 0xF0:  // LOCK
        case 0x26:  // segments without effect
        case 0x2E:
        case 0x36:
        case 0x3E:
          break;
        default:
          return read_last_prefix();
      }
      code_.take();
    }
  }

  bool read_last_prefix() {
    const std::uint8_t byte = code_.peek();
    if (byte == 0xC4 || byte == 0xC5) return read_vex();
    if ((byte & 0xF0) == 0x40) {
      code_.take();
      prefix_.rex = true;
      prefix_.wide = (byte & 8) != 0;
      prefix_.reg = byte << 1 & 8;
      prefix_.index = byte << 2 & 8;
      prefix_.base = byte << 3 & 8;
    }
    if (code_.peek() == 0x0F) {
      code_.take();
      prefix_.map = 1;
    }
    return true;
  }

  bool read_vex() {
    if (prefix_.operand16 || prefix_.repeat || prefix_.repeat_not) return false;
    const bool three = code_.take() == 0xC4;
    std::uint32_t last = code_.take();
    prefix_.vex = true;
    prefix_.map = 1;
    prefix_.reg = (~last >> 7 & 1) * 8;
    if (three) {
      prefix_.index = (~last >> 6 & 1) * 8;
      prefix_.base = (~last >> 5 & 1) * 8;
      prefix_.map = last & 0x1F;
      last = code_.take();
      prefix_.wide = (last & 0x80) != 0;
    }
    prefix_.ymm = (last & 4) != 0;
    prefix_.operand16 = (last & 3) == 1;
    prefix_.repeat = (last & 3) == 2;
    prefix_.repeat_not = (last & 3) == 3;
    return true;
  }

  // ModRM, SIB and displacement. @returns false if the operand is a register
  bool read_operand() {
    const std::uint32_t byte = code_.take(), mode = byte >> 6, base = byte & 7;
    reg_ = byte >> 3 & 7;
    if (mode == 3) return false;
    std::uint64_t address = 0;
    bool no_base = false;
    if (base == kRsp) {
      const std::uint32_t sib = code_.take(), index = (sib >> 3 & 7) | prefix_.index;
      if (index != kRsp) address += cpu_->general[index] << (sib >> 6);
      no_base = (sib & 7) == kRbp && mode == 0;
      if (!no_base) address += cpu_->general[(sib & 7) | prefix_.base];
    } else if (mode == 0 && base == kRbp) {
      no_base = rip_relative_ = true;
    } else {
      address += cpu_->general[base | prefix_.base];
    }
    if (mode == 1) address += code_.take_signed(1);
    if (mode == 2 || no_base) address += code_.take_signed(4);
    store_.address = address;
    return true;
  }

  [[nodiscard]] std::uint32_t full_width() const {
    return prefix_.wide ? 8 : prefix_.operand16 ? 2 : 4;
  }

  void take_register() {
    store_.source = reg_ | prefix_.reg;
    store_.high_byte = store_.width == 1 && !prefix_.rex && reg_ >= 4;
    const std::uint64_t value = cpu_->general[store_.high_byte ? reg_ - 4 : store_.source];
    store_.operand = (store_.high_byte ? value >> 8 : value) & mask_of(store_.width);
  }

  bool from_register(StoreKind kind, std::uint32_t width) {
    if (!read_operand()) return false;
    store_.kind = kind;
    store_.width = width;
    take_register();
    return true;
  }

  bool from_immediate(StoreKind kind, std::uint32_t width, std::uint32_t bytes) {
    store_.kind = kind;
    store_.width = width;
    store_.operand = code_.take_signed(bytes) & mask_of(width);
    return true;
  }

  bool alone(StoreKind kind, std::uint32_t width) {
    store_.kind = kind;
    store_.width = width;
    return true;
  }

  // ADD to XOR by their number in instructions; 7 is CMP.
  static StoreKind arithmetic(std::uint32_t number) {
    return static_cast<StoreKind>(static_cast<std::uint32_t>(StoreKind::Add) + number);
  }

  bool decode_string(StoreKind kind, std::uint32_t width) {
    alone(kind, width);
    const std::uint64_t mask = prefix_.address32 ? 0xFFFF'FFFF : ~std::uint64_t{0};
    store_.address = cpu_->general[kRdi] & mask;
    store_.operand =
        kind == StoreKind::Fill ? cpu_->general[kRax] & mask_of(width) : cpu_->general[kRsi] & mask;
    store_.repeated = prefix_.repeat || prefix_.repeat_not;
    return !prefix_.address32;
  }

  // The last bit of most opcodes chooses between a byte and the full width.
  [[nodiscard]] std::uint32_t width_of(std::uint8_t opcode) const {
    return (opcode & 1) == 0 ? 1 : full_width();
  }

  bool decode_one_byte(std::uint8_t opcode) {
    const std::uint32_t width = width_of(opcode);
    const std::uint32_t immediate = width == 8 ? 4 : width;
    if (opcode < 0x38 && (opcode & 7) < 2) return from_register(arithmetic(opcode >> 3), width);
    switch (opcode) {
      case 0x80:
      case 0x81:
      case 0x83:
        return read_operand() && reg_ != 7 &&
               from_immediate(arithmetic(reg_), width, opcode == 0x81 ? immediate : 1);
      case 0x86:
      case 0x87:
        return from_register(StoreKind::Exchange, width);
      case 0x88:
      case 0x89:
        return from_register(StoreKind::Move, width);
      case 0xA4:
      case 0xA5:
        return decode_string(StoreKind::Copy, width);
      case 0xAA:
      case 0xAB:
        return decode_string(StoreKind::Fill, width);
      case 0xC6:
      case 0xC7:
        return read_operand() && reg_ == 0 && from_immediate(StoreKind::Move, width, immediate);
      case 0xF6:
      case 0xF7:
        return read_operand() && (reg_ == 2 || reg_ == 3) &&
               alone(reg_ == 2 ? StoreKind::Not : StoreKind::Negate, width);
      case 0xFE:
      case 0xFF:
        return read_operand() && reg_ < 2 &&
               alone(reg_ == 0 ? StoreKind::Increment : StoreKind::Decrement, width);
      default:
        return false;
    }
  }

  bool decode_two_bytes(std::uint8_t opcode) {
    const std::uint32_t width = width_of(opcode);
    if (opcode == 0xB0 || opcode == 0xB1)
      return from_register(StoreKind::CompareAndExchange, width);
    if (opcode == 0xC0 || opcode == 0xC1) return from_register(StoreKind::ExchangeAndAdd, width);
    if (opcode == 0xC3 && !prefix_.operand16)  // MOVNTI
      return from_register(StoreKind::Move, full_width());
    return decode_vector(opcode);
  }

  bool from_vector(std::uint32_t width, std::uint32_t begin = 0) {
    if (!read_operand()) return false;
    store_.kind = StoreKind::Vector;
    store_.width = width;
    store_.vector_begin = begin;
    store_.source = reg_ | prefix_.reg;
    return true;
  }

  // A part of an XMM register.
  bool from_half(std::uint32_t width, std::uint32_t begin) {
    return !prefix_.ymm && from_vector(width, begin);
  }

  [[nodiscard]] std::uint32_t vector_width() const { return prefix_.ymm ? 32 : 16; }
  // Of MOVSS, MOVSD, MOVUPS and MOVUPD.
  [[nodiscard]] std::uint32_t moved_width() const {
    return prefix_.repeat ? 4 : prefix_.repeat_not ? 8 : vector_width();
  }

  // Moves of XMM and YMM registers to memory: the legacy forms, and those of VEX map 1.
  bool decode_vector(std::uint8_t opcode) {
    const std::uint32_t whole = vector_width();
    const bool packed = !prefix_.repeat && !prefix_.repeat_not;
    const bool integer = packed && prefix_.operand16;
    switch (opcode) {
      case 0x11:  // MOVUPS, MOVUPD, MOVSS, MOVSD
        return from_vector(moved_width());
      case 0x13:  // MOVLPS, MOVLPD
        return packed && from_half(8, 0);
      case 0x17:  // MOVHPS, MOVHPD
        return packed && from_half(8, 8);
      case 0x29:  // MOVAPS, MOVAPD
      case 0x2B:  // MOVNTPS, MOVNTPD
        return packed && from_vector(whole);
      case 0x7E:  // MOVD, MOVQ
        return integer && from_half(prefix_.wide ? 8 : 4, 0);
      case 0x7F:  // MOVDQA, MOVDQU
        return (prefix_.repeat || integer) && from_vector(whole);
      case 0xD6:  // MOVQ
        return integer && from_half(8, 0);
      case 0xE7:  // MOVNTDQ
        return integer && from_vector(whole);
      default:
        return false;
    }
  }

  bool decode_vex(std::uint8_t opcode) {
    if (prefix_.map == 1) return decode_vector(opcode);
    // VEXTRACTF128, VEXTRACTI128
    if (prefix_.map != 3 || (opcode != 0x19 && opcode != 0x39) || !prefix_.ymm) return false;
    if (!prefix_.operand16 || !from_vector(16)) return false;
    store_.vector_begin = (code_.take() & 1) * 16;
    return true;
  }

  Code code_;
  const CpuState* cpu_;
  Prefixes prefix_;
  StoreInstruction store_;
  std::uint32_t reg_ = 0;  ///< of ModRM
  bool rip_relative_ = false;
};

}  // namespace

std::optional<StoreInstruction> decode_store(std::span<const std::uint8_t> code,
                                             const CpuState& cpu) noexcept {
  return Decoder{code, cpu}.decode();
}

}  // namespace rths::scramnet
