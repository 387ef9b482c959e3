/* SPDX-License-Identifier: Apache-2.0
 *
 * The vendor's API of SCRAMNet GT: the header that clients include. Programs written for the cards
 * compile with it and run on a ring in software; docs/scramnet.md describes the differences.
 *
 * The vendor added const in 2021. Define SCGT_API_BEFORE_2021 for the older prototypes. */
#ifndef __SCGT_API_H__
#define __SCGT_API_H__

#include "gtucore.h"
#include "systypes.h"

#ifdef __cplusplus
extern "C" {
#endif

#ifdef SCGT_API_BEFORE_2021
#define SCGT_API_CONST
#else
#define SCGT_API_CONST const
#endif

typedef struct _scgtHandle {
  int osHandle;
  uint32 unitNum;
  uint32* memMapPtr;
  uint32 memMapSize;
} scgtHandle;

typedef uint32 scgtIntrHandle; /* -1 before the first use */

extern const char* scgtapiRevisionStr;
const char* scgtGetApiRevStr(void);
SCGT_API_CONST char* scgtGetErrStr(uint32 code);

uint32 scgtOpen(uint32 unit, scgtHandle* handle);
uint32 scgtClose(scgtHandle* handle);
void* scgtMapMem(scgtHandle* handle);
void scgtUnmapMem(scgtHandle* handle);
uint32 scgtGetDeviceInfo(scgtHandle* handle, scgtDeviceInfo* info);

/* Offsets and lengths in bytes. */
uint32 scgtWrite(scgtHandle* handle, uint32 offset, SCGT_API_CONST void* data, uint32 bytes,
                 uint32 flags, uint32* done, SCGT_API_CONST scgtInterrupt* interrupt);
uint32 scgtRead(scgtHandle* handle, uint32 offset, void* data, uint32 bytes, uint32 flags,
                uint32* done);
uint32 scgtGetInterrupt(scgtHandle* handle, scgtIntrHandle* cursor,
                        SCGT_API_CONST scgtInterrupt* interrupts, uint32 count, uint32 timeout_ms,
                        uint32* returned);

uint32 scgtGetState(scgtHandle* handle, uint32 state);
uint32 scgtSetState(scgtHandle* handle, uint32 state, uint32 value);
uint32 scgtReadCR(scgtHandle* handle, uint32 offset);
uint32 scgtWriteCR(scgtHandle* handle, uint32 offset, uint32 value);
uint32 scgtReadNMR(scgtHandle* handle, uint32 offset);
uint32 scgtWriteNMR(scgtHandle* handle, uint32 offset, uint32 value);
uint32 scgtGetStats(scgtHandle* handle, uint32* values, char* names, uint32 first, uint32 count);

#undef SCGT_API_CONST
#ifdef __cplusplus
}
#endif
#endif
