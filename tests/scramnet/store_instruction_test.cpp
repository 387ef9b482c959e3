// SPDX-License-Identifier: Apache-2.0
//
// The decoder of traps against the processor: assembled instructions are executed, and decoded from
// the same state.

#include <algorithm>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <rths/card/store_instruction.hpp>

#if defined(__x86_64__)

// Addresses: rdi, rbx, rbp, r8, r12, r13, rsi. Indices and counts: rcx, r14. Others: values.
// clang-format off
#define RTHS_MODIFIED(X, op)                                                                       \
  X(op "b %al, 3(%rdi)") X(op "b %ah, (%rbx)") X(op "b %r9b, (%r8)") X(op "w %dx, 6(%rbp)")        \
  X(op "l %edx, (%rdi)") X(op "l %r10d, 8(%r13)") X(op "q %r11, -64(%r12,%r14,8)")                 \
  X("lock " op "l %eax, 4(%rdi)") X(op "b $0x85, (%rdi)") X(op "w $0x8512, (%rdi)")                \
  X(op "l $0x12345678, (%rdi)") X(op "q $-77, (%rdi)") X(op "l $5, 0x400(%rbx,%rcx,2)")
#define RTHS_ALONE(X, op)                                                                          \
  X(op "b (%rdi)") X(op "w 2(%r13)") X(op "l (%rbx,%rcx,4)") X(op "q (%r12)") X("lock " op "l (%rdi)")
#define RTHS_EXCHANGED(X, op)                                                                      \
  X(op " %al, (%rdi)") X(op " %dh, (%rdi)") X(op " %sil, (%rbx)") X(op " %dx, (%rdi)")             \
  X(op " %edx, (%r8)") X(op " %r15, (%r12)") X(op " %eax, (%rdi)")
#define RTHS_SAMPLES(X)                                                                            \
  X("movb %al, (%rdi)") X("movb %dh, 1(%rdi)") X("movb %sil, (%rdi)") X("movb %r9b, (%rdi)")       \
  X("movb %bpl, (%rdi)") X("movw %ax, (%rdi)") X("movl %eax, (%rdi)") X("movq %rdx, (%rdi)")       \
  X("movl %r15d, (%r8)") X("movq %r15, (%r13)") X("movl %edx, (%r12)") X("movl %edx, (%rbp,%rcx)") \
  X("movl %edx, -128(%rbp)") X("movl %edx, 0x120(%r13,%r14,4)") X("movq %rax, (%rbx,%rcx,8)")      \
  X("movl %eax, rths_buffer+1400(%rip)") X("movl $77, rths_buffer+1400(%rip)")                     \
  X("addw $300, rths_buffer+1400(%rip)") X("movl %eax, 0x40(,%r15,8)")                             \
  X("movb $0x9c, (%rdi)") X("movw $0x9cde, 2(%rdi)") X("movl $0x9cde0123, (%rdi)")                 \
  X("movq $-3, (%rdi)") X("movb $1, (%r12,%r14)")                                                  \
  X("movntil %eax, (%rdi)") X("movntiq %r9, (%r8)")                                                \
  X("stosb") X("stosw") X("stosl") X("stosq") X("rep stosb") X("rep stosw") X("rep stosl")         \
  X("rep stosq") X("movsb") X("movsw") X("movsl") X("movsq") X("rep movsb") X("rep movsw")         \
  X("rep movsl") X("rep movsq")                                                                    \
  RTHS_MODIFIED(X, "add") RTHS_MODIFIED(X, "or") RTHS_MODIFIED(X, "adc") RTHS_MODIFIED(X, "sbb")   \
  RTHS_MODIFIED(X, "and") RTHS_MODIFIED(X, "sub") RTHS_MODIFIED(X, "xor")                          \
  RTHS_ALONE(X, "inc") RTHS_ALONE(X, "dec") RTHS_ALONE(X, "not") RTHS_ALONE(X, "neg")              \
  RTHS_EXCHANGED(X, "xchg") RTHS_EXCHANGED(X, "xadd") RTHS_EXCHANGED(X, "cmpxchg")                 \
  RTHS_EXCHANGED(X, "lock xadd") RTHS_EXCHANGED(X, "lock cmpxchg")                                 \
  X("movss %xmm0, (%rdi)") X("movsd %xmm15, (%r8)") X("movd %xmm9, (%rdi)") X("movq %xmm7, (%rdi)")\
  X("movups %xmm9, 3(%rdi)") X("movupd %xmm0, (%rdi)") X("movaps %xmm7, (%rdi)")                   \
  X("movapd %xmm15, (%r13)") X("movdqa %xmm9, (%r12)") X("movdqu %xmm0, 1(%rbp,%r14,2)")           \
  X("movntps %xmm7, (%rdi)") X("movntpd %xmm7, (%rdi)") X("movntdq %xmm9, (%rdi)")                 \
  X("movlps %xmm9, (%rdi)") X("movhps %xmm9, (%rdi)") X("movlpd %xmm0, (%rdi)")                    \
  X("movhpd %xmm15, (%rdi)") X(".byte 0x66, 0x48, 0x0f, 0x7e, 0x07")                               \
  X("vmovss %xmm0, (%rdi)") X("vmovsd %xmm15, (%r8)") X("vmovd %xmm9, (%rdi)")                     \
  X("vmovq %xmm7, (%rdi)") X("vmovups %xmm9, (%rdi)") X("vmovups %ymm9, 3(%rdi)")                  \
  X("vmovaps %ymm0, (%rdi)") X("vmovapd %ymm7, (%r13)") X("vmovdqu %ymm15, (%r8,%r14,4)")          \
  X("vmovdqa %xmm15, (%r12)") X("vmovdqa %ymm9, (%rdi)") X("vmovntdq %ymm0, (%rdi)")               \
  X("vmovntps %ymm7, (%rdi)") X("vmovlps %xmm9, (%rdi)") X("vmovhps %xmm9, (%rdi)")                \
  X("vextractf128 $1, %ymm9, (%rdi)") X("vextractf128 $0, %ymm15, (%r12)")                        \
  X("vextracti128 $1, %ymm7, (%rdi)") X("vmovd %xmm9, (%r8)") X("vmovd %xmm15, (%r13,%r14)") X(".byte 0x26; movl %eax, (%rdi)")                           \
  X(".byte 0x2e; movl %eax, (%rdi)") X(".byte 0x36; movl %eax, (%rdi)")                            \
  X(".byte 0x3e; movl %eax, (%rdi)") X(".byte 0xf2; lock addl %eax, (%rdi)")
// Not stores to memory, or not decoded.
#define RTHS_OTHERS(X)                                                                             \
  X("movl (%rdi), %eax") X("cmpl %eax, (%rdi)") X("cmpl $3, (%rdi)") X("cmpb $3, (%rdi)") X("cmpb %al, (%rdi)") X("addb (%rdi), %al") X("xorl (%rdi), %eax")          \
  X("testl %eax, (%rdi)") X("testb $3, (%rdi)") X("movl %eax, %edx") X("addl %eax, %edx")          \
  X("notl %eax") X("incl %eax") X("nop") X("movups (%rdi), %xmm0") X("movq (%rdi), %xmm0")         \
  X("movups %xmm0, %xmm1") X("vmovups (%rdi), %ymm0") X("setg (%rdi)") X("movl %eax, %fs:(%rdi)")  \
  X("shll $1, (%rdi)") X("mulb (%rdi)") X("pushq (%rdi)") X("movq %mm0, (%rdi)") X("lea (%rdi), %rax")\
  X("movntq %mm0, (%rdi)") X("bts %eax, (%rdi)") X("vmovups %xmm0, %xmm1") X("jmp *(%rdi)")        \
  X("vpmaskmovd %xmm0, %xmm1, (%rdi)") X("popq (%rdi)") X("call *(%rdi)") X("addr32 stosl") X("cmpxchg8b (%rdi)")
// clang-format on

#define RTHS_ASSEMBLE(text) \
  "1: " text "\n ret\n .pushsection rths_samples, \"aw\"\n .quad 1b\n .popsection\n"
#define RTHS_ASSEMBLE_OTHER(text) \
  "1: " text "\n ret\n .pushsection rths_others, \"aw\"\n .quad 1b\n .popsection\n"
#define RTHS_NAME(text) text,

// rths_run(state, code) puts the state into the registers, calls the code, and reads them back.
asm(R"(
  .pushsection .bss
  .balign 64
  .hidden rths_buffer
  .globl rths_buffer
rths_buffer: .skip 4096
  .hidden rths_vectors
  .globl rths_vectors
rths_vectors: .skip 128
rths_state: .skip 8
rths_code: .skip 8
  .popsection
  .pushsection .text
  .hidden rths_run
  .globl rths_run
rths_run:
  push %rbx; push %rbp; push %r12; push %r13; push %r14; push %r15; sub $8, %rsp
  mov %rdi, rths_state(%rip)
  mov %rsi, rths_code(%rip)
  vmovdqu rths_vectors(%rip), %ymm0
  vmovdqu rths_vectors+32(%rip), %ymm7
  vmovdqu rths_vectors+64(%rip), %ymm9
  vmovdqu rths_vectors+96(%rip), %ymm15
  push 128(%rdi)
  mov 0(%rdi), %rax; mov 8(%rdi), %rcx; mov 16(%rdi), %rdx; mov 24(%rdi), %rbx
  mov 40(%rdi), %rbp; mov 48(%rdi), %rsi; mov 64(%rdi), %r8; mov 72(%rdi), %r9
  mov 80(%rdi), %r10; mov 88(%rdi), %r11; mov 96(%rdi), %r12; mov 104(%rdi), %r13
  mov 112(%rdi), %r14; mov 120(%rdi), %r15; mov 56(%rdi), %rdi
  popf
  call *rths_code(%rip)
  pushf; push %rax
  mov rths_state(%rip), %rax
  mov %rcx, 8(%rax); mov %rdx, 16(%rax); mov %rbx, 24(%rax); mov %rbp, 40(%rax)
  mov %rsi, 48(%rax); mov %rdi, 56(%rax); mov %r8, 64(%rax); mov %r9, 72(%rax)
  mov %r10, 80(%rax); mov %r11, 88(%rax); mov %r12, 96(%rax); mov %r13, 104(%rax)
  mov %r14, 112(%rax); mov %r15, 120(%rax)
  cld
  pop 0(%rax); pop 128(%rax)
  vzeroupper
  add $8, %rsp; pop %r15; pop %r14; pop %r13; pop %r12; pop %rbp; pop %rbx
  ret
)" RTHS_SAMPLES(RTHS_ASSEMBLE) RTHS_OTHERS(RTHS_ASSEMBLE_OTHER) ".popsection\n");

extern "C" {
extern std::uint8_t rths_buffer[4096];
extern std::uint8_t rths_vectors[128];
extern const std::uint8_t* __start_rths_samples[];
extern const std::uint8_t* __stop_rths_samples[];
extern const std::uint8_t* __start_rths_others[];
extern const std::uint8_t* __stop_rths_others[];
void rths_run(rths::scramnet::CpuState* state, const std::uint8_t* code);
}

namespace rths::scramnet {
namespace {

constexpr const char* kNames[] = {RTHS_SAMPLES(RTHS_NAME)};
constexpr const char* kOtherNames[] = {RTHS_OTHERS(RTHS_NAME)};

constexpr std::uint32_t kRsp = 4;
constexpr std::uint64_t kArithmeticFlags = 0x8D5, kAdjust = 0x10, kDirection = 0x400;

std::span<const std::uint8_t> code_at(const std::uint8_t* at) { return {at, kLongestInstruction}; }
std::uint64_t address_of(const std::uint8_t* at) { return reinterpret_cast<std::uint64_t>(at); }

/// Registers that point into the buffer, small indices, random values.
CpuState random_state(std::mt19937_64& random) {
  CpuState cpu;
  for (auto& value : cpu.general) value = random();
  for (const std::size_t pointer : {3, 5, 6, 7, 8, 12, 13})
    cpu.general[pointer] = address_of(rths_buffer) + 1024 + random() % 16 * 64;
  cpu.general[kRsi] += 1024;
  cpu.general[kRcx] = 1 + random() % 9;
  cpu.general[14] = random() % 9;
  cpu.general[15] = (address_of(rths_buffer) + 2048) / 8;
  cpu.flags = 0x202 | (random() & (kArithmeticFlags | kDirection));
  return cpu;
}

std::uint64_t load(std::uint64_t address, std::uint32_t width) {
  std::uint64_t value = 0;
  std::memcpy(&value, reinterpret_cast<const void*>(address), width);
  return value;
}

void put(std::uint64_t address, const void* value, std::size_t width) {
  std::memcpy(reinterpret_cast<void*>(address), value, width);
}

/// Makes the store in the way of the handler, with memory and vectors of this process.
void make(const StoreInstruction& store, CpuState& cpu) {
  if (store.kind == StoreKind::Vector) {
    const std::size_t place = store.source == 0   ? 0
                              : store.source == 7 ? 1
                              : store.source == 9 ? 2
                                                  : 3;
    put(store.address, rths_vectors + 32 * place + store.vector_begin, store.width);
    return finish(store, 0, {}, cpu);
  }
  if (store.kind == StoreKind::Fill || store.kind == StoreKind::Copy) {
    const std::uint64_t step = ascends(cpu) ? store.width : -std::uint64_t{store.width};
    const std::uint64_t elements = elements_left(store, cpu);
    for (std::uint64_t i = 0; i < elements; ++i) {
      const std::uint64_t value = store.kind == StoreKind::Fill
                                      ? store.operand
                                      : load(store.operand + i * step, store.width);
      put(store.address + i * step, &value, store.width);
    }
    return advance(store, elements, cpu);
  }
  const std::uint64_t before = load(store.address, store.width);
  ReadModifyWrite result{store.operand, cpu.flags, true};
  if (store.reads_memory()) result = modify(store, before, cpu);
  if (result.stores) put(store.address, &result.stored, store.width);
  finish(store, before, result, cpu);
}

// The flag that the manual leaves undefined after OR, AND and XOR.
std::uint64_t defined_flags(const StoreInstruction& store) {
  const bool logical =
      store.kind == StoreKind::Or || store.kind == StoreKind::And || store.kind == StoreKind::Xor;
  return logical ? kArithmeticFlags & ~kAdjust : kArithmeticFlags;
}

void compare_with_processor(const std::string& name, const std::uint8_t* code,
                            std::mt19937_64& random) {
  CpuState predicted = random_state(random);
  for (std::size_t i = 0; i < sizeof rths_buffer; ++i)
    rths_buffer[i] = static_cast<std::uint8_t>(random());
  for (auto& byte : rths_vectors) byte = static_cast<std::uint8_t>(random());
  if (random() % 3 == 0)  // comparisons succeed
    for (const std::size_t pointer : {3, 7, 8, 12})
      put(predicted.general[pointer], &predicted.general[kRax], 8);
  predicted.next = address_of(code);
  const CpuState begin = predicted;
  const std::vector<std::uint8_t> memory(rths_buffer, rths_buffer + sizeof rths_buffer);

  const auto store = decode_store(code_at(code), predicted);
  ASSERT_TRUE(store) << name;
  CpuState executed = begin;
  rths_run(&executed, code);
  const std::vector<std::uint8_t> after(rths_buffer, rths_buffer + sizeof rths_buffer);
  std::copy(memory.begin(), memory.end(), rths_buffer);
  make(*store, predicted);

  EXPECT_TRUE(std::equal(after.begin(), after.end(), rths_buffer)) << name;
  EXPECT_EQ(code[predicted.next - begin.next], 0xC3) << name;  // RET follows
  for (std::size_t i = 0; i < 16; ++i) {
    if (i == kRsp) continue;
    EXPECT_EQ(predicted.general[i], executed.general[i]) << name << ", register " << i;
  }
  const std::uint64_t flags = defined_flags(*store);
  EXPECT_EQ(predicted.flags & flags, executed.flags & flags) << name;
}

TEST(StoreInstructions, DoWhatTheProcessorDoes) {
  if (__builtin_cpu_supports("avx2") == 0) GTEST_SKIP() << "SKIPPED: no AVX2";
  std::mt19937_64 random{1};
  const std::uint8_t** code = __start_rths_samples;
  for (const std::string name : kNames) {
    for (int i = 0; i < 60 && !testing::Test::HasFailure(); ++i)
      compare_with_processor(name, *code, random);
    ++code;
  }
  EXPECT_EQ(code, __stop_rths_samples);
}

TEST(StoreInstructions, AreNotFoundInOtherInstructions) {
  CpuState cpu;
  const std::uint8_t** code = __start_rths_others;
  for (const std::string name : kOtherNames)
    EXPECT_FALSE(decode_store(code_at(*code++), cpu)) << name;
  EXPECT_EQ(code, __stop_rths_others);
}

TEST(StoreInstructions, AreNotDecodedIfTheyAreCut) {
  std::mt19937_64 random{1};
  for (const std::uint8_t** code = __start_rths_samples; code != __stop_rths_samples; ++code) {
    const CpuState cpu = random_state(random);
    const auto whole = decode_store(code_at(*code), cpu);
    ASSERT_TRUE(whole);
    for (std::size_t length = 0; length < whole->length; ++length)
      EXPECT_FALSE(decode_store(code_at(*code).first(length), cpu));
    EXPECT_TRUE(decode_store(code_at(*code).first(whole->length), cpu));
  }
}

TEST(StoreInstructions, HaveAddressesOfTheStackAndOf32Bits) {
  CpuState cpu;
  cpu.general[kRsp] = 0x7000'0000'1000;
  cpu.general[kRdi] = 0x1'0000'0010;
  const std::uint8_t on_stack[] = {0x89, 0x44, 0x24, 0xF8};    // mov %eax, -8(%rsp)
  const std::uint8_t in_32_bits[] = {0x67, 0x89, 0x47, 0x04};  // mov %eax, 4(%edi)
  const std::uint8_t absolute[] = {0x89, 0x04, 0x25, 0x00, 0x20, 0x00, 0x80};
  EXPECT_EQ(decode_store(on_stack, cpu)->address, 0x7000'0000'0FF8U);
  cpu.general[2] = 0x20;
  cpu.general[3] = 0x5000;
  const std::uint8_t with_index[] = {0x89, 0x04, 0x93};  // mov %eax, (%rbx,%rdx,4)
  EXPECT_EQ(decode_store(with_index, cpu)->address, 0x5080U);
  EXPECT_EQ(decode_store(in_32_bits, cpu)->address, 0x14U);
  EXPECT_EQ(decode_store(absolute, cpu)->address, 0xFFFF'FFFF'8000'2000U);
}

// Random bytes: what is decoded is decoded from its own bytes alone.
TEST(StoreInstructions, AreDecodedFromTheirBytesAlone) {
  std::mt19937_64 random{1};
  constexpr std::uint8_t kLikely[] = {0x66, 0xF2, 0xF3, 0x48, 0x4C, 0x0F,
                                      0xC5, 0xC4, 0x89, 0x11, 0x7F, 0x81};
  int found = 0;
  for (int i = 0; i < 60'000; ++i) {
    std::vector<std::uint8_t> code(random() % (kLongestInstruction + 3));
    for (auto& byte : code) byte = static_cast<std::uint8_t>(random());
    for (std::size_t at = 0; at < std::min<std::size_t>(code.size(), random() % 4); ++at)
      code[at] = kLikely[random() % std::size(kLikely)];
    const CpuState cpu = random_state(random);
    const auto store = decode_store(code, cpu);
    if (!store) continue;
    ++found;
    ASSERT_LE(store->length, std::min(code.size(), kLongestInstruction));
    ASSERT_TRUE(store->width == 1 || store->width == 2 || store->width == 4 || store->width == 8 ||
                store->width == 16 || store->width == 32);
    ASSERT_LE(store->vector_begin + store->width, 32U);
    const std::vector<std::uint8_t> own(code.begin(), code.begin() + store->length);
    const auto again = decode_store(own, cpu);
    ASSERT_TRUE(again);
    ASSERT_EQ(again->address, store->address);
    ASSERT_EQ(again->operand, store->operand);
    ASSERT_FALSE(decode_store({own.data(), own.size() - 1}, cpu));
  }
  EXPECT_GT(found, 2000);
}

}  // namespace
}  // namespace rths::scramnet

#endif
