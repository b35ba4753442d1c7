# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause

    .section .rodata
    .global pliant_page_begin
    .global pliant_page_end
    .hidden pliant_page_begin
    .hidden pliant_page_end
pliant_page_begin:
    .incbin PLIANT_PAGE
pliant_page_end:
    .section .note.GNU-stack, "", %progbits
