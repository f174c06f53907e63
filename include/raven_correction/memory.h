// SPDX-License-Identifier: BSD-3-Clause
// How a program treats memory that it has freed: a choice of the whole process, so programs make it
// and the library does not. Any room may use it.
#pragma once

namespace raven_correction {

/// Keeps freed memory for the next allocation rather than giving it back to the system. Large
/// matrices are otherwise mapped and unmapped again and again, and fetching their pages takes
/// longer than computing with them: on a virtual machine an online update took twice as long. Call
/// it first thing in main(). Does nothing where the C library is not glibc.
void keepFreedMemory() noexcept;

}  // namespace raven_correction
