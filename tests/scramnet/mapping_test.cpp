// SPDX-License-Identifier: Apache-2.0
#include "vendor_ring.hpp"

#include <scrplus.h>

namespace {

using Mapping = rths::test::VendorRing;

TEST_F(Mapping, GivesAccessToMemoryAndRegisters) {
  ASSERT_EQ(sp_scram_init(0), 0);
  ASSERT_EQ(sp_scram_init(), 0);

  EXPECT_NE(scr_registers_mapped, 0);
  EXPECT_NE(scr_memory_mapped, 0);
  EXPECT_GE(scr_csr_fd, 0);
  EXPECT_EQ(sp_plus_flag, 1);
  EXPECT_EQ(sp_mem_size(), 2U << 20U);
  EXPECT_EQ(scr_csr_read(SCR_CSR8) & CSR8_MSIZMSK, 3U << 12U);
  EXPECT_NE(get_base_mem(), nullptr);
  EXPECT_EQ(get_base_mem(), get_base_mem());
}

TEST_F(Mapping, MapsAndUnmapsInAnyOrderRepeatedly) {
  for (int round = 0; round < 2; ++round) {
    EXPECT_EQ(scr_reg_mm(MAP), 0);
    EXPECT_EQ(scr_reg_mm(MAP), 0);
    EXPECT_EQ(scr_mem_mm(MAP), 0);
    EXPECT_EQ(scr_mem_mm(MAP), 0);
    EXPECT_EQ(scr_reg_mm(UNMAP), 0);
    EXPECT_EQ(scr_mem_mm(UNMAP), 0);
    EXPECT_EQ(scr_mem_mm(UNMAP), 0);
    EXPECT_EQ(scr_reg_mm(UNMAP), 0);
  }
}

TEST_F(Mapping, HasNoMemoryAndNoAcrWhileUnmapped) {
  ASSERT_EQ(sp_scram_init(0), 0);
  SCR_LONG_PTR base = get_base_mem();
  scr_acr_write(3, ACR_RIE);
  ASSERT_EQ(scr_probe_mm(const_cast<unsigned*>(base), 4), 0);

  scr_mem_mm(UNMAP);

  EXPECT_EQ(get_base_mem(), nullptr);
  EXPECT_EQ(scr_acr_read(3), 0xFF);
  scr_acr_write(3, 0);
  EXPECT_EQ(scr_probe_mm(const_cast<unsigned*>(base), 4), -1);
  scr_mem_mm(MAP);
  EXPECT_EQ(scr_acr_read(3), ACR_RIE);
}

TEST_F(Mapping, KeepsMemoryAcrossUnmapping) {
  ASSERT_EQ(sp_scram_init(0), 0);
  get_base_mem()[1234] = 77;
  scr_mem_mm(UNMAP);

  scr_mem_mm(MAP);

  EXPECT_EQ(get_base_mem()[1234], 77U);
}

TEST_F(Mapping, ListsTheProcessOnTheRing) {
  ASSERT_EQ(sp_scram_init(0), 0);

  const auto report = rths::broker::inspect_ring(ring());

  ASSERT_TRUE(report && report->usable);
  ASSERT_EQ(report->occupants.size(), 1U);
  EXPECT_EQ(report->occupants[0].pid, getpid());
  EXPECT_EQ(report->bytes / (2U << 20U), 1U);
}

TEST_F(Mapping, RefusesSwapModesWithAWarning) {
  ASSERT_EQ(sp_scram_init(0), 0);
  EXPECT_EQ(sp_stm_mm(Long_mode), TRUE);
  EXPECT_EQ(sp_stm_mm(77), TRUE);
  testing::internal::CaptureStderr();
  EXPECT_EQ(sp_stm_mm(Word_mode), FALSE);
  EXPECT_EQ(sp_stm_mm(Byte_mode), FALSE);
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            "scramnet: byte-swapped windows are not supported; the mode stays Long_mode\n");
  EXPECT_EQ(sp_gtm_mm(), Long_mode);
}

TEST_F(Mapping, PassesCallsOnOtherDescriptorsToTheKernel) {
  ASSERT_EQ(sp_scram_init(0), 0);
  int pipe_ends[2];
  ASSERT_EQ(pipe(pipe_ends), 0);
  ASSERT_EQ(write(pipe_ends[1], "four", 4), 4);
  int waiting = 0;

  EXPECT_EQ(ioctl(pipe_ends[0], FIONREAD, &waiting), 0);
  EXPECT_EQ(waiting, 4);
  EXPECT_EQ(ioctl(-1, FIONREAD, &waiting), -1);
  EXPECT_EQ(errno, EBADF);
  EXPECT_EQ(ioctl(scr_csr_fd, 99), -1);
  EXPECT_EQ(errno, EINVAL);
  close(pipe_ends[0]);
  close(pipe_ends[1]);
}

// A wrong configuration gives an error code and one line on standard error.
TEST_F(Mapping, ReportsAConfigurationErrorOnce) {
  const rths::test::TemporaryFolder folder;
  const auto file = folder.write("card.toml", "[scramnet]\nring = 5\n");
  setenv("RTHS_SCRAMNET_CONFIG", file.c_str(), 1);

  const auto finished = rths::test::Running{client("lehigh")}.wait();

  unsetenv("RTHS_SCRAMNET_CONFIG");
  EXPECT_NE(finished.exit_code, 0);
  EXPECT_EQ(finished.err.find("scramnet: " + file.string() + ":2:"), 0U) << finished.err;
  EXPECT_EQ(finished.err.find("scramnet:", 1), std::string::npos) << finished.err;
}

}  // namespace
