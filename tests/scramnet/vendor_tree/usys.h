/* SPDX-License-Identifier: Apache-2.0
 *
 * Modelled on the header of the vendor's tools, which includes the tree's own types. */
#ifndef _USYS_H_
#define _USYS_H_

#ifndef PLATFORM_UNIX
#error "Must define PLATFORM_UNIX"
#endif
#include <pthread.h>
#include <stdlib.h>
#include <sys/types.h>

#include "systypes.h"

typedef struct {
  uint32 startTimeSecs, startTimeUsecs;
} usysMsTimeType;

#endif
