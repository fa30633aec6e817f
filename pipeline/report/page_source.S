/* The page of a report without its data, byte for byte, and what the studio has besides; hidden:
   only this library refers to them. */
    .section .rodata
    .macro embed name, file
    .global \name
    .hidden \name
\name:
    .incbin "\file"
    .global \name\()_end
    .hidden \name\()_end
\name\()_end:
    .byte 0
    .endm
    embed miebrdf_report_page, MIEBRDF_REPORT_PAGE
    embed miebrdf_studio_page, MIEBRDF_STUDIO_PAGE
    embed miebrdf_studio_script, MIEBRDF_STUDIO_SCRIPT
    .section .note.GNU-stack, "", %progbits
