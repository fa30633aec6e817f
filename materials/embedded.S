/* The embedded database, byte for byte; hidden: only this library refers to it. */
    .section .rodata
    .balign 16
    .global miebrdf_embedded_database
    .hidden miebrdf_embedded_database
miebrdf_embedded_database:
    .incbin MIEBRDF_EMBEDDED_FILE
    .global miebrdf_embedded_database_end
    .hidden miebrdf_embedded_database_end
miebrdf_embedded_database_end:
    .byte 0
    .global miebrdf_common_words
    .hidden miebrdf_common_words
miebrdf_common_words:
    .incbin MIEBRDF_COMMON_WORDS
    .global miebrdf_common_words_end
    .hidden miebrdf_common_words_end
miebrdf_common_words_end:
    .byte 0
    .section .note.GNU-stack, "", %progbits
