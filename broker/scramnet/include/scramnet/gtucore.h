/* SPDX-License-Identifier: Apache-2.0
 *
 * Constants and structures of the SCRAMNet GT interface, by its vendor's names. */
#ifndef __GT_UCORE_H__
#define __GT_UCORE_H__

#include "systypes.h"

#define SCGT_MAX_DEVICES 16

/* Return values */
#define SCGT_SUCCESS 0
#define SCGT_SYSTEM_ERROR 1
#define SCGT_BAD_PARAMETER 2
#define SCGT_DRIVER_ERROR 3
#define SCGT_TIMEOUT 4
#define SCGT_CALL_UNSUPPORTED 5
#define SCGT_INSUFFICIENT_RESOURCES 6
#define SCGT_LINK_ERROR 7
#define SCGT_MISSED_INTERRUPTS 8
#define SCGT_DRIVER_MISSED_INTERRUPTS 9
#define SCGT_DMA_UNSUPPORTED 10
#define SCGT_HARDWARE_ERROR 11

/* scgtGetState, scgtSetState */
#define SCGT_NODE_ID 0
#define SCGT_ACTIVE_LINK 1
#define SCGT_NUM_LINK_ERRS 2
#define SCGT_EWRAP 3
#define SCGT_WRITE_ME_LAST 4
#define SCGT_UNICAST_INT_MASK 5
#define SCGT_BROADCAST_INT_MASK 6
#define SCGT_INT_SELF_ENABLE 7
#define SCGT_RING_SIZE 8
#define SCGT_UPSTREAM_NODE_ID 9
#define SCGT_NET_TIMER_VAL 10
#define SCGT_LATENCY_TIMER_VAL 11
#define SCGT_SM_TRAFFIC_CNT 12
#define SCGT_SPY_SM_TRAFFIC_CNT 13
#define SCGT_SPY_NODE_ID 14
#define SCGT_TRANSMIT_ENABLE 15
#define SCGT_RECEIVE_ENABLE 16
#define SCGT_RETRANSMIT_ENABLE 17
#define SCGT_LASER_0_ENABLE 18
#define SCGT_LASER_1_ENABLE 19
#define SCGT_LINK_UP 20
#define SCGT_LASER_0_SIGNAL_DET 21
#define SCGT_LASER_1_SIGNAL_DET 22
#define SCGT_D64_ENABLE 23
#define SCGT_BYTE_SWAP_ENABLE 24
#define SCGT_WORD_SWAP_ENABLE 25
#define SCGT_LINK_ERR_INT_ENABLE 26
#define SCGT_READ_BYPASS_ENABLE 27

/* scgtInterrupt.type */
#define SCGT_UNICAST_INTR 0
#define SCGT_BROADCAST_INTR 1
#define SCGT_ERROR_INTR 2
#define SCGT_NO_INTR 3

/* Flags of a transfer; the vendor spells two of them SCGR */
#define SCGT_RW_PIO 0x1
#define SCGT_RW_DMA_BYTE_SWAP 0x2
#define SCGT_RW_DMA_WORD_SWAP 0x4
#define SCGT_RW_DMA_PHYS_ADDR 0x8
#define SCGR_RW_PIO_8_BIT 0x10
#define SCGR_RW_PIO_16_BIT 0x20

typedef struct _scgtDeviceInfo {
  uint32 reserved;
  char driverRevisionStr[128];
  char boardLocationStr[128];
  uint32 unitNum;
  uint32 popMemSize;
  uint32 mappedMemSize;
  uint32 numLinks;
  uint32 revisionID;
} scgtDeviceInfo;

typedef struct _scgtInterrupt {
  uint32 type;
  uint32 sourceNodeID;
  uint32 id;
  uint32 val;
  uint32 seqNum;
} scgtInterrupt;

#endif
