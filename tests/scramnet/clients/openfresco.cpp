// SPDX-License-Identifier: Apache-2.0
//
// Modelled on OpenFresco's SCRAMNet control: maps without initialising, plain words, no sleep.
//   openfresco STEPS
#include <sched.h>

#include <cstdio>
#include <cstdlib>

extern "C" {
#include <scrplus.h>
}

namespace {

constexpr int kSignals = 4;
constexpr int kByteOffset = 4096;

/// Words of the partition: newTarget, commands, switchPC, atTarget, feedbacks.
struct Partition {
  volatile int* new_target;
  volatile float* command;
  volatile int* switch_pc;
  volatile int* at_target;
  volatile float* feedback;
};

void wait_for(volatile int* flag, int value) {
  for (unsigned turn = 0; *flag != value; ++turn)
    if (turn % 64 == 63) sched_yield();  // both programs may share one processor
}

bool step(const Partition& ring, int number) {
  for (int i = 0; i < kSignals; ++i) ring.command[i] = static_cast<float>(number + i);
  *ring.new_target = 1;
  wait_for(ring.switch_pc, 1);
  *ring.new_target = 0;
  wait_for(ring.switch_pc, 0);
  wait_for(ring.at_target, 1);
  for (int i = 0; i < kSignals; ++i)
    if (ring.feedback[i] != static_cast<float>(2 * (number + i))) return false;
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return 9;
  if (scr_reg_mm(MAP) != 0 || scr_mem_mm(MAP) != 0) return 1;
  int* base = (int*)get_base_mem();  // C cast, as in OpenFresco
  if (base == nullptr) return 2;
  scr_csr_write(SCR_CSR3, 10);
  if (sp_stm_mm(Long_mode) != TRUE) return 3;
  scr_csr_write(SCR_CSR0, 0x8003);
  int* const at = base + kByteOffset / 4;
  const Partition ring{at, reinterpret_cast<float*>(at + 1), at + kSignals + 1, at + kSignals + 2,
                       reinterpret_cast<float*>(at + kSignals + 3)};
  *ring.new_target = 0;
  wait_for(ring.at_target, 1);
  const int steps = std::atoi(argv[1]);
  for (int i = 1; i <= steps; ++i)
    if (!step(ring, i)) return 4;
  *ring.new_target = -1;
  wait_for(ring.at_target, -1);  // the controller has seen it
  *ring.new_target = 0;
  if (scr_reg_mm(UNMAP) != 0 || scr_mem_mm(UNMAP) != 0) return 5;
  std::printf("%d steps\n", steps);
  return 0;
}
