/* SPDX-License-Identifier: Apache-2.0
 *
 * The vendor's API of SCRAMNet+: register bits, limits of the PCI card, and calls of the Windows
 * library. Clients include scrplus.h. */
#ifndef __SCRPCI__
#define __SCRPCI__

#include "scr.h"

#ifdef __cplusplus
extern "C" {
#endif

#define MAX_PCI_CARDS 10
#define SCR_MAX_DMA_LEN 0x100000
#define CORE_VERSION "1.64"
#define HWD_VERSION "PCI-2.02"
#define SCR_INTERRUPT_OBJECT "SCRAMNet_Int_Object"

typedef struct {
  uint32_t offset;
  uint32_t bytes;
  uint64_t user_address;
} TScramnetDMAControl;

/* CSR0: general */
#define CSR0_RXEN 0x1
#define CSR0_TXEN 0x2
#define CSR0_TWO 0x4
#define CSR0_HIE 0x8
#define CSR0_IME 0x10
#define CSR0_MME 0x20
#define CSR0_ORF 0x40
#define CSR0_IOE 0x80
#define CSR0_NIE 0x100
#define CSR0_OTF 0x200
#define CSR0_DDE 0x400
#define CSR0_EN4K 0x800
#define CSR0_RTRF 0x1000
#define CSR0_RIF 0x2000
#define CSR0_RSMF 0x4000
#define CSR0_INSRT 0x8000

/* CSR1: status; reading clears the latched bits */
#define CSR1_SMFF 0x1
#define CSR1_SMFNE 0x2
#define CSR1_SMHF 0x4
#define CSR1_RTFF 0x8
#define CSR1_IFF 0x10
#define CSR1_SMFS 0x20
#define CSR1_CD 0x40
#define CSR1_BB 0x80
#define CSR1_RXO 0x100
#define CSR1_RTRY 0x200
#define CSR1_IARM 0x4000
#define CSR1_FOBN 0x8000
/* the same bits by the plus card's names */
#define CSR1_TXFF 0x1
#define CSR1_TXFNE 0x2
#define CSR1_TXF78 0x4
#define CSR1_INTFF 0x10
#define CSR1_PV 0x20
#define CSR1_BM 0x80
#define CSR1_TXRTY 0x200
#define CSR1_TXRTO 0x400
#define CSR1_GPCO 0x1000

/* CSR2: modes */
#define CSR2_BTBS 0x1
#define CSR2_BTWS 0x2
#define CSR2_WTBS 0x4
#define CSR2_WTWS 0x8
#define CSR2_LTBS 0x10
#define CSR2_LTWS 0x20
#define CSR2_DFOLB 0x40
#define CSR2_EWLB 0x80
#define CSR2_DHMW 0x100
#define CSR2_WOS 0x200
#define CSR2_ISEN 0x400
#define CSR2_ETCS 0x800
#define CSR2_LLIM 0x800
#define CSR2_VLEN 0x1000
#define CSR2_HIPRO 0x2000
#define CSR2_MMSG 0x4000
#define CSR2_BRST 0x8000

/* CSR5: interrupt FIFO, as read */
#define CSR5_RB 0x4000
#define CSR5_IFE 0x8000

/* CSR8: extended control */
#define CSR8_IDMX 0x1
#define CSR8_DHLD 0x2
#define CSR8_CSEL 0x4
#define CSR8_EXCS 0x8
#define CSR8_MWDO 0x10
#define CSR8_EPRE 0x20
#define CSR8_MCLK 0x40
#define CSR8_EDIN 0x80
#define CSR8_ARST 0x100
#define CSR8_FREE 0x200
#define CSR8_IOVR 0x400
#define CSR8_MESW 0x800
#define CSR8_MSIZMSK 0x7000
#define CSR8_PHNT 0x8000

/* CSR9: mask of error interrupts, counter mode */
#define CSR9_TXFF 0x1
#define CSR9_TXFNE 0x2
#define CSR9_TXF78 0x4
#define CSR9_BIST 0x8
#define CSR9_INTFF 0x10
#define CSR9_PV 0x20
#define CSR9_CD 0x40
#define CSR9_BM 0x80
#define CSR9_RXO 0x100
#define CSR9_TXRTY 0x200
#define CSR9_TXRTO 0x400
#define CSR9_RTRF 0x800
#define CSR9_IUCO 0x1000
#define CSR9_TRGC 0x2000
#define CSR9_ERRC 0x4000
#define CSR9_FOBN 0x8000

#define CSR10_SMAEN 0x1
#define CSR12_VPEN 0x1

/* The offset counts units of the access width. */
unsigned int ReadSCRLong(unsigned long offset, void* value);
unsigned short ReadSCRWord(unsigned long offset, void* value);
unsigned char ReadSCRByte(unsigned long offset, void* value);
int WriteSCRLong(unsigned long offset, unsigned int value);
int WriteSCRWord(unsigned long offset, unsigned short value);
int WriteSCRByte(unsigned long offset, unsigned char value);

#ifdef _WINNT
#include "scrwin.h"
#endif

#ifdef __cplusplus
}
#endif
#endif
