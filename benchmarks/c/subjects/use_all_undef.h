#undef decoder
#undef take
#undef taken
#undef subject_init
#undef subject_push
#undef subject_feed
#undef subject_encode
