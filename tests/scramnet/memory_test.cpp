// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <fstream>

#include "vendor_ring.hpp"

#include <scrplus.h>

namespace {

class CardMemory : public rths::test::VendorRing {
 protected:
  void SetUp() override {
    ASSERT_EQ(sp_scram_init(0), 0);
    scr_reset_mm();
    scr_mclr_mm(MEM);
  }
};

TEST_F(CardMemory, IsClearedAndFilled) {
  scr_smem_mm(MEM, 0x12345678);
  EXPECT_EQ(get_base_mem()[0], 0x12345678U);
  EXPECT_EQ(get_base_mem()[sp_mem_size() / 4 - 1], 0x12345678U);
  scr_mclr_mm(77);
  EXPECT_EQ(get_base_mem()[0], 0x12345678U);
  scr_mclr_mm(MEM);
  EXPECT_EQ(get_base_mem()[0], 0U);
}

TEST_F(CardMemory, IsIndependentOfTheAcrWhichKeepsFiveBits) {
  get_base_mem()[7] = 0xDEADBEEF;
  scr_acr_write(7, 0xFF);
  EXPECT_EQ(scr_acr_read(7), 0x1F);
  EXPECT_EQ(scr_acr_read(sp_mem_size()), 0xFF);
  scr_smem_mm(ACR, ACR_TIE);
  EXPECT_EQ(scr_acr_read(99), ACR_TIE);
  scr_csr_write(SCR_CSR0, 0x8103);
  scr_mclr_mm(ACR);
  EXPECT_EQ(scr_acr_read(99), 0);
  EXPECT_EQ(scr_csr_read(SCR_CSR0), 0x8103);
  EXPECT_EQ(get_base_mem()[7], 0xDEADBEEFU);
}

TEST_F(CardMemory, ShowsTheAcrInItsWindowWhileCsr0SelectsIt) {
  SCR_LONG_PTR base = get_base_mem();
  base[5] = 55;
  scr_acr_write(5, ACR_TIE);

  scr_acr_mm(MAP);
  EXPECT_EQ(base[5], unsigned{ACR_TIE});
  base[6] = 0xFF;
  scr_acr_mm(UNMAP);

  EXPECT_EQ(base[5], 55U);
  EXPECT_EQ(base[6], 0U);
  EXPECT_EQ(scr_acr_read(6), 0x1F);
  EXPECT_EQ(get_base_mem(), base);
}

TEST_F(CardMemory, IsCopiedByByteOffsetAndLength) {
  std::array<unsigned, 4> out{1, 2, 3, 4};
  std::array<unsigned, 4> in{};
  EXPECT_EQ(scr_dma_write(out.data(), 4096, sizeof out), 0);
  EXPECT_EQ(get_base_mem()[1025], 2U);
  EXPECT_EQ(scr_dma_read(in.data(), 4096, sizeof in), 0);
  EXPECT_EQ(in, out);
  EXPECT_EQ(scr_dma_write(out.data(), sp_mem_size() - 4, 8), -1);
  EXPECT_EQ(scr_dma_read(nullptr, 0, 4), -1);
}

TEST_F(CardMemory, IsReadInUnitsOfTheAccess) {
  unsigned value = 0;
  EXPECT_EQ(WriteSCRLong(10, 0x01020304), 1);
  EXPECT_EQ(ReadSCRLong(10, &value), 0x01020304U);
  EXPECT_EQ(value, 0x01020304U);
  EXPECT_EQ(WriteSCRWord(21, 0xAAAA), 1);
  EXPECT_EQ(WriteSCRByte(40, 0xBB), 1);
  EXPECT_EQ(get_base_mem()[10], 0xAAAA03BBU);
  EXPECT_EQ(ReadSCRWord(21, nullptr), 0xAAAA);
  EXPECT_EQ(ReadSCRByte(40, nullptr), 0xBB);
}

TEST_F(CardMemory, IsRestoredFromItsFile) {
  const rths::test::TemporaryFolder folder;
  std::string file = (folder.path() / "image").string();
  std::string acr = (folder.path() / "acr").string();
  get_base_mem()[3] = 0xCAFE;
  scr_acr_write(4, ACR_RIE | ACR_TIE);
  ASSERT_EQ(scr_save_mm(file.data(), MEM), 0);
  ASSERT_EQ(scr_save_mm(acr.data(), ACR), 0);
  scr_mclr_mm(MEM);
  scr_mclr_mm(ACR);

  ASSERT_EQ(scr_load_mm(file.data(), MEM), 0);
  ASSERT_EQ(scr_load_mm(acr.data(), ACR), 0);

  EXPECT_EQ(get_base_mem()[3], 0xCAFEU);
  EXPECT_EQ(scr_acr_read(4), ACR_RIE | ACR_TIE);
  EXPECT_EQ(scr_save_mm(file.data(), 7), -6);
}

TEST_F(CardMemory, IsLoadedByTheFormatsOfTheFile) {
  const rths::test::TemporaryFolder folder;
  const auto load = [&](const std::string& text) {
    std::string file = folder.write("image", text).string();
    return scr_load_mm(file.data(), MEM);
  };
  EXPECT_EQ(load("8:1.5:%f:4\nc:-2:%d:4\n10:ff:%x:1\n"), 0);
  EXPECT_EQ(get_base_mem()[2], 0x3FC00000U);
  EXPECT_EQ(get_base_mem()[3], 0xFFFFFFFEU);
  EXPECT_EQ(get_base_mem()[4], 0xFFU);
  EXPECT_EQ(load("200000:1:%x:4\n"), -5);
  EXPECT_EQ(load("nonsense\n"), -4);
  EXPECT_EQ(load("0:1:%x:3\n"), -4);
  std::string missing = (folder.path() / "none").string();
  EXPECT_EQ(scr_load_mm(missing.data(), MEM), -3);
}

}  // namespace
