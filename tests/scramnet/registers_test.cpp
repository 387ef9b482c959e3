// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "vendor_ring.hpp"

#include <scrplus.h>

namespace {

class Csr : public rths::test::VendorRing {
 protected:
  void SetUp() override {
    ASSERT_EQ(sp_scram_init(0), 0);
    scr_reset_mm();
  }
};

TEST_F(Csr, HaveTheirPowerUpValuesAfterAReset) {
  scr_csr_write(SCR_CSR8, CSR8_ARST);

  EXPECT_EQ(scr_csr_read(SCR_CSR0), 0);
  EXPECT_EQ(scr_csr_read(SCR_CSR2), 0xC040);
  EXPECT_EQ(scr_csr_read(SCR_CSR8), 0x8800 | 3 << 12);
  EXPECT_EQ(scr_csr_read(SCR_CSR9), 0x0029);
  EXPECT_EQ(scr_csr_read(SCR_CSR10), 0x0001);
  EXPECT_EQ(scr_csr_read(SCR_CSR11), 0x0080);
  EXPECT_EQ(scr_csr_read(SCR_CSR12), 0);
  EXPECT_EQ(scr_csr_read(SCR_CSR15), 0x0020);
}

TEST_F(Csr, IgnoreAccessToIndicesWithoutARegister) {
  for (const int csr : {6, 7, 11, 14, 15, 16, 40, -1}) {
    scr_csr_write(csr, 0);
    static_cast<void>(scr_csr_read(csr));
  }
  EXPECT_EQ(scr_csr_read(SCR_CSR0), 0);
}

TEST_F(Csr, ReadAsAllOnesWhileUnmapped) {
  scr_reg_mm(UNMAP);
  EXPECT_EQ(scr_csr_read(SCR_CSR0), 0xFFFF);
  scr_csr_write(SCR_CSR0, 3);
  scr_reg_mm(MAP);
  EXPECT_EQ(scr_csr_read(SCR_CSR0), 0);
}

TEST_F(Csr, HaveTheIdInTheHighByteAndTheNodeCountInTheLow) {
  scr_csr_write(SCR_CSR0, 0x8003);
  scr_csr_write(SCR_CSR3, 0x2A07);
  EXPECT_EQ(scr_csr_read(SCR_CSR3) & 0xFF00, 0x2A00);
  EXPECT_GE(scr_csr_read(SCR_CSR3) & 0xFF, 1);
  unsigned char id = 0;
  unsigned char count = 0;
  scr_id_mm(&id, &count);
  EXPECT_EQ(id, 0x2A);
  EXPECT_GE(count, 1);
  EXPECT_EQ(sp_txrx_id(9), 0x2A);
  EXPECT_EQ(sp_rx_id(11), 9);
  EXPECT_EQ(sp_rx_id(9), 11);
  EXPECT_EQ(sp_rx_id(256), -1);
  EXPECT_EQ(sp_plus_find(), 1);
  EXPECT_EQ(scr_csr_read(SCR_CSR3) >> 8, 9);
}

TEST_F(Csr, KeepTheAgeBesideTheReceiveId) {
  EXPECT_EQ(sp_msg_life(200), 255);
  EXPECT_EQ(sp_msg_life(255), 200);
  EXPECT_EQ(sp_msg_life(0), -1);
  EXPECT_EQ(sp_msg_life(256), -1);
}

TEST_F(Csr, NeverReadBackTheTimeOut) {
  EXPECT_EQ(sp_net_to(16), 0);
  EXPECT_EQ(scr_csr_read(SCR_CSR5), 0);
}

TEST_F(Csr, ChangeTheProtocolAndReturnTheOldOne) {
  scr_csr_write(SCR_CSR2, 0xC840);
  EXPECT_EQ(sp_protocol(PLATINUM_PLUS), BURST);
  EXPECT_EQ(scr_csr_read(SCR_CSR2), 0x5840);
  EXPECT_EQ(sp_protocol(GOLD), PLATINUM_PLUS);
  EXPECT_EQ(sp_protocol(7), -1);
  scr_csr_write(SCR_CSR2, 0x8000);
  EXPECT_EQ(sp_protocol(BURST), 0);
}

TEST_F(Csr, ArmOnAnyWriteOfCsr1) {
  EXPECT_EQ(scr_csr_read(SCR_CSR1), 0);
  scr_csr_write(SCR_CSR1, 0);
  EXPECT_EQ(scr_csr_read(SCR_CSR1), CSR1_IARM);
  EXPECT_EQ(scr_fswin_mm(), 1);
}

TEST_F(Csr, ReadBackResetBitsWhileTheyAreSet) {
  scr_csr_write(SCR_CSR0, 0xF000);
  EXPECT_EQ(scr_csr_read(SCR_CSR0), 0xF000);
  scr_csr_write(SCR_CSR0, 0x8003);
  EXPECT_EQ(scr_csr_read(SCR_CSR0), 0x8003);
}

TEST_F(Csr, CountFreelyAndReportAnOverflow) {
  EXPECT_EQ(sp_set_cntr(CNTR_FREERUN), 0);
  while (scr_csr_read(SCR_CSR13) == 0) {
  }
  while ((scr_csr_read(SCR_CSR1) & 0x1000) == 0) {  // 26.66 ns × 65536 = 1.75 ms
  }
  EXPECT_EQ(sp_set_cntr(CNTR_ERRORS), 0);
  EXPECT_EQ(scr_csr_read(SCR_CSR13), 0);
  scr_csr_write(SCR_CSR13, 99);
  EXPECT_EQ(scr_csr_read(SCR_CSR13), 99);
  EXPECT_EQ(scr_csr_read(SCR_CSR8) & CSR8_FREE, 0);
  EXPECT_EQ(sp_set_cntr(0), -1);
  for (const int mode : {CNTR_TRIGS, CNTR_TRANSIT, CNTR_NET_EVENTS, CNTR_FREERUN_T2})
    EXPECT_EQ(sp_set_cntr(mode), 0);
  sp_set_cntr(CNTR_ERRORS);
}

TEST_F(Csr, AreChangedByTheModeCallsBitForBit) {
  scr_lnk_mm(SCR_LNK);
  EXPECT_EQ(scr_csr_read(SCR_CSR0), 0x8003);
  EXPECT_EQ(scr_csr_read(SCR_CSR2), 0x0040);
  scr_int_mm(TX_INT, SET_INT | INTALL);
  EXPECT_EQ(scr_csr_read(SCR_CSR0), 0x8303);
  scr_int_mm(TX_INT, SET_INT);
  EXPECT_EQ(scr_csr_read(SCR_CSR0), 0x8103);
  scr_int_mm(RX_INT, SET_INT | INTALL | INTOWN);
  EXPECT_EQ(scr_csr_read(SCR_CSR0), 0x816B);
  EXPECT_EQ(scr_csr_read(SCR_CSR2), 0x0640);
  scr_int_mm(RX_INT, SET_INT | RST_INT);
  EXPECT_EQ(scr_csr_read(SCR_CSR0), 0x8103);
  EXPECT_EQ(scr_csr_read(SCR_CSR2), 0x0240);
  scr_int_mm(INT_ERR, SET_INT);
  EXPECT_EQ(scr_csr_read(SCR_CSR0), 0x818B);
  scr_int_mm(INT_ERR, RST_INT);
  scr_int_mm(TX_INT, RST_INT);
  EXPECT_EQ(scr_csr_read(SCR_CSR0), 0x800B);
  scr_dfltr_mm(FLT_ALL);
  EXPECT_EQ(scr_csr_read(SCR_CSR0), 0x8C0B);
  scr_dfltr_mm(FLT_HGH);
  EXPECT_EQ(scr_csr_read(SCR_CSR0), 0x840B);
  scr_dfltr_mm(FLT_OFF);
  scr_wml_mm(NTW_WRT_HST);
  EXPECT_EQ(scr_csr_read(SCR_CSR2), 0x0340);
  scr_nwh_mm(RST_NWH);
  EXPECT_EQ(scr_csr_read(SCR_CSR2), 0x0040);
  scr_lnk_mm(RST_LNK);
  EXPECT_EQ(scr_csr_read(SCR_CSR0), 0x0008);
}

TEST_F(Csr, AreAccessibleThroughRequests) {
  struct rw_scr request = {REG_WRT, 2, 0x4040};
  scr_rw_mm(&request);
  request = {REG_MDFY, 2, 0x0300};
  scr_rw_mm(&request);
  request = {REG_RD, 2, 0};
  scr_rw_mm(&request);
  EXPECT_EQ(request.csr_arg, 0x4340);
  testing::internal::CaptureStderr();
  request = {REG_WRT, 4, 1};
  scr_rw_mm(&request);
  request = {REG_RD, 6, 1};
  scr_rw_mm(&request);
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            "scramnet: scr_rw_mm: register 4 is read-only\n"
            "scramnet: scr_rw_mm: register 6 cannot be accessed\n");
  EXPECT_EQ(ioctl(scr_csr_fd, RW_CSR, &(request = {REG_RD, 2, 0})), 0);
  EXPECT_EQ(request.csr_arg, 0x4340);
}

TEST_F(Csr, HaveNoPagesBeyondTheRing) {
  EXPECT_EQ(sp_set_vp(VP_SET, 0), 0);
  EXPECT_EQ(sp_set_vp(VP_SET, 1), -1);
  EXPECT_EQ(sp_set_vp(VP_READ, 0), 0);
  EXPECT_EQ(sp_set_vp(VP_RESET, 0), 0);
  EXPECT_EQ(sp_set_vp(9, 0), -1);
  EXPECT_EQ(sp_set_sm_addr(0x12345678), 0);
  EXPECT_EQ(scr_csr_read(SCR_CSR10), 0x5001);
  EXPECT_EQ(scr_csr_read(SCR_CSR11), 0x1234);
  int bits[3];
  EXPECT_EQ(sp_bist_rd(bits), 0);
  EXPECT_EQ(sp_bist_rd(nullptr), -1);
}

TEST_F(Csr, PrintErrorsLineByLine) {
  FILE* file = std::tmpfile();
  scr_error_mm(file, 0xFFFF);
  std::rewind(file);
  int lines = 0;
  for (int c = 0; (c = std::fgetc(file)) != EOF;) lines += c == '\n' ? 1 : 0;
  std::fclose(file);
  EXPECT_EQ(lines, 9);  // bits of 0x7F9
}

}  // namespace
