/* SPDX-License-Identifier: Apache-2.0
 *
 * A copy of a part of the vendor's header, as a tree may have it. */
#ifndef __GT_UCORE_H__
#define __GT_UCORE_H__

#include "../systypes.h"

#define SCGT_SUCCESS 0
#define SCGT_NODE_ID 0

typedef struct _scgtDeviceInfo {
  uint32 reserved;
  char driverRevisionStr[128];
  char boardLocationStr[128];
  uint32 unitNum, popMemSize, mappedMemSize, numLinks, revisionID;
} scgtDeviceInfo;

typedef struct _scgtInterrupt {
  uint32 type, sourceNodeID, id, val, seqNum;
} scgtInterrupt;

#endif
