/* SPDX-License-Identifier: Apache-2.0
 *
 * The vendor's API of SCRAMNet+: types, constants, configuration, and the functions of every card.
 * Clients include scrplus.h. docs/scramnet.md describes the behaviour of the calls. */
#ifndef RTHS_SCR_H
#define RTHS_SCR_H

#include <stdint.h>
#include <stdio.h>
#include <sys/ioctl.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A longword has 32 bits on every host. */
typedef volatile unsigned int* SCR_LONG_PTR;
typedef volatile unsigned short* SCR_SHORT_PTR;
typedef volatile unsigned char* SCR_BYTE_PTR;
typedef volatile unsigned int* DWORDPTR;
typedef volatile unsigned short* WORDPTR;
typedef volatile unsigned char* BYTEPTR;
typedef unsigned int SCR_LONG_DATA;
typedef int SCR_INT;
typedef uint64_t SCR_ADDR_TYPE;
#ifndef __cplusplus
typedef unsigned char byte;
#endif

#ifndef TRUE
#define TRUE 1
#endif
#ifndef FALSE
#define FALSE 0
#endif

/* Register indices. There is no register 16. */
#define SCR_CSR0 0
#define SCR_CSR1 1
#define SCR_CSR2 2
#define SCR_CSR3 3
#define SCR_CSR4 4
#define SCR_CSR5 5
#define SCR_CSR6 6
#define SCR_CSR7 7
#define SCR_CSR8 8
#define SCR_CSR9 9
#define SCR_CSR10 10
#define SCR_CSR11 11
#define SCR_CSR12 12
#define SCR_CSR13 13
#define SCR_CSR14 14
#define SCR_CSR15 15
#define SCR_CSR16 16

/* rw_scr.rw_flag */
#define REG_WRT 0
#define REG_RD 1
#define REG_MDFY 4

/* Arguments */
#define MAP 0
#define UNMAP 1
#define MEM 0
#define ACR 0x10
#define RESET 1
#define RX_ENB 1
#define TX_ENB 2
#define INTALL 1
#define INTACR 4
#define INTOWN 8
#define SET_INT 32
#define RST_INT 16
#define CLR_INT 16
#define SET_SIG 0
#define CLR_SIG 1
#define ERR_INT 0x200
#define AUTO_VECTOR 0
#define WRITE_ME_LAST 6
#define WRITE_DIRECT 7
#define FLT_OFF 0
#define FLT_HGH 0x400
#define FLT_ALL 0xc00
#define RST_LNK 16
#define RST_BSWP 1
#define RST_NWH 1

/* Commands of calls, and of ioctl() on scr_csr_fd or a descriptor of SCR_INT_DEV */
#define INTSIG 1
#define SCR_LNK 2
#define TX_INT 3
#define RX_INT 4
#define INT_ERR 5
#define NTW_WRT_HST 6
#define DATA_FLT 7
#define BYTE_SWP 8
#define ACT_ND 9
#define RW_CSR 10
#define RST_FIFO 11
#define AUX_RAM_LNK 12
#define INT_DIAG1 13
#define RD_FIFO 14
#define FLUSHSIG 15
#define SCR_IOCTL_MIN 0
#define SCR_IOCTL_MAX 15
#define SCR_MAX_PROC 0x20
#define WAIT_INTERRUPT 16 /* blocks; our value: no source gives the vendor's */

#define Long_mode 0
#define Word_mode 1
#define Byte_mode 2

/* Defaults and current configuration */
#define SCR_REG_BASE_DEF 0x2000
#define SCR_MEM_BASE_DEF 0xA0C00000
#define SCR_MEM_LEN_DEF 0x200000
#define SCR_VECTOR_DEF 0x0F
#define SCR_PAGE_LEN_DEF 0x200000
#define SCR_NODE_ID_DEF 0xf2
#define SCR_NET_TO_DEF 0xff
#define SCR_CSR_DEV_DEF "/dev/eisa/eisa0io"
#define SCR_MEM_DEV_DEF "/dev/eisa/eisa0mem"
#define SCR_INT_DEV_DEF "/dev/scr"
#define SCR_PAGE_LEN SCR_PAGE_LEN_DEF

typedef struct _scram_config {
  unsigned long scram_reg_addr, scram_mem_addr, scram_mem_size;
  unsigned short scram_mem_vect, scram_err_vect, scram_node_id, scram_net_to;
  char *scram_mem_dev, *scram_reg_dev, *scram_int_dev;
} SCRAM_CFG;

/* Defined in the library, with or without CONFIG_EXTERN. */
extern SCRAM_CFG Scramnet_config;

#ifdef NO_CONFIG
#define SCR_REG_BASE SCR_REG_BASE_DEF
#define SCR_MEM_BASE SCR_MEM_BASE_DEF
#define SCR_MEM_LEN SCR_MEM_LEN_DEF
#define SCR_VECTOR SCR_VECTOR_DEF
#define SCR_NODE_ID SCR_NODE_ID_DEF
#define SCR_NET_TO SCR_NET_TO_DEF
#define SCR_CSR_DEV SCR_CSR_DEV_DEF
#define SCR_MEM_DEV SCR_MEM_DEV_DEF
#define SCR_INT_DEV SCR_INT_DEV_DEF
#else
#define SCR_REG_BASE Scramnet_config.scram_reg_addr
#define SCR_MEM_BASE Scramnet_config.scram_mem_addr
#define SCR_MEM_LEN Scramnet_config.scram_mem_size
#define SCR_VECTOR Scramnet_config.scram_mem_vect
#define SCR_NODE_ID Scramnet_config.scram_node_id
#define SCR_NET_TO Scramnet_config.scram_net_to
#define SCR_CSR_DEV Scramnet_config.scram_reg_dev
#define SCR_MEM_DEV Scramnet_config.scram_mem_dev
#define SCR_INT_DEV Scramnet_config.scram_int_dev
#endif

struct rw_scr {
  char rw_flag;
  char csr_reg;
  unsigned short csr_arg;
};

union scr_fifo_ptr {
  unsigned int ntr_addr;
  unsigned short ntr_fifo[2];
};

struct rd_fifo {
  union { /* both views are accessible directly and through fifo_ptr */
    unsigned int ntr_addr;
    unsigned short ntr_fifo[2];
    union scr_fifo_ptr fifo_ptr;
  };
  char mt_flag, smff, smfne, smfhf, rtff, iff, smfs, cd, bb, rxo, dum1, dum2;
};

struct scr_csr {
  unsigned short csr_regs[16];
};

struct scr_device {
  unsigned short scr_csr0, scr_csr1, scr_csr2, scr_csr3, scr_csr4, scr_csr5, scr_csr6, scr_csr7;
};

/* State of this process; clients may redeclare these */
extern int scr_csr_fd;
extern int scr_registers_mapped;
extern int scr_memory_mapped;
extern int sp_plus_flag; /* 1: the card is a SCRAMNet+ */

/* Mapping */
int scr_reg_mm(int command);
int scr_mem_mm(int command);
SCR_LONG_PTR get_base_mem(void);
int scr_probe_mm(void* address, unsigned short size);

/* Registers */
unsigned short scr_csr_read(int csr);
void scr_csr_write(int csr, unsigned short value);
void scr_rw_mm(struct rw_scr* request);
void scr_id_mm(void* id, void* count);
void scr_reset_mm(void);
void scr_dfltr_mm(int filter);
void scr_lnk_mm(int command);
void scr_wml_mm(int command);
#define scr_nwh_mm scr_wml_mm
int scr_fswin_mm(void);
void scr_error_mm(FILE* to, unsigned short csr1);
void scr_bswp_mm(void);

/* Auxiliary control RAM, by index of the longword */
void scr_acr_mm(int command);
unsigned char scr_acr_read(unsigned long longword);
void scr_acr_write(unsigned long longword, unsigned char value);

/* Interrupts */
void scr_int_mm(int command, int argument);
int scr_read_int_fifo(void* byte_address); /* writes 32 bits if there is an entry */
void scr_fifo_mm(int command, struct rd_fifo* fifo);

/* Whole memories, files, copies; lengths and offsets in bytes */
void scr_mclr_mm(int which);
void scr_smem_mm(int which, unsigned long value);
int scr_load_mm(char* file, int which);
int scr_save_mm(char* file, int which);
int scr_dma_read(void* user, unsigned long offset, unsigned long length);
int scr_dma_write(void* user, unsigned long offset, unsigned long length);

#ifdef __cplusplus
}
#endif
#endif
