// The part of uqr that makes QR codes. The build bundles it into one small file of this name.
export {encode} from 'uqr';
