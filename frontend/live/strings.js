// The words of everything but the scope, the timeline and the transport (strings-scope.js): one file a language.

export {en} from './i18n/en.js';
export {zh} from './i18n/zh.js';
