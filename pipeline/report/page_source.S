/* The page of a report without its data, byte for byte; hidden: only this library refers to it. */
    .section .rodata
    .global miebrdf_report_page
    .hidden miebrdf_report_page
miebrdf_report_page:
    .incbin MIEBRDF_REPORT_PAGE
    .global miebrdf_report_page_end
    .hidden miebrdf_report_page_end
miebrdf_report_page_end:
    .byte 0
    .section .note.GNU-stack, "", %progbits
