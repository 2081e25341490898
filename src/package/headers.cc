// SPDX-License-Identifier: MIT
// With this source, CMake precompiles the headers that those of the library share.
