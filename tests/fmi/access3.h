/* SPDX-License-Identifier: Apache-2.0
 *
 * Functions of FMI 3 that read and write the types that an FMU does not use. */
#include <rths/fmi/fmi3.h>

#define UNUSED_ACCESS(NUMBER)                                                           \
  fmi3Get##NUMBER##TYPE fmi3Get##NUMBER;                                                \
  fmi3Set##NUMBER##TYPE fmi3Set##NUMBER;                                                \
  fmi3Status fmi3Get##NUMBER(fmi3Instance c, const fmi3ValueReference refs[], size_t n, \
                             fmi3##NUMBER values[], size_t count) {                     \
    (void)c, (void)refs, (void)n, (void)values, (void)count;                            \
    return fmi3Error;                                                                   \
  }                                                                                     \
  fmi3Status fmi3Set##NUMBER(fmi3Instance c, const fmi3ValueReference refs[], size_t n, \
                             const fmi3##NUMBER values[], size_t count) {               \
    (void)c, (void)refs, (void)n, (void)values, (void)count;                            \
    return fmi3Error;                                                                   \
  }
