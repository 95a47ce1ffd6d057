// SPDX-License-Identifier: BSD-3-Clause
// The unit whose headers all tests share.
