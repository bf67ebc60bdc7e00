#[test]fn t(){}
